# SPDX-License-Identifier: MIT
# The library keeps no state of its own, says nothing unless asked and leaves the process of its host
# alone: no header has a variable of static storage that can change, none outside io writes to a stream,
# none takes signals, exits, sets handlers, the locale, the environment or the working folder.
#   cmake -D SOURCE_DIR=<repository> -P cmake/CheckGlobals.cmake
cmake_minimum_required(VERSION 3.25)

set(errors "")
file(GLOB_RECURSE headers RELATIVE "${SOURCE_DIR}/include" "${SOURCE_DIR}/include/vadose/*.hpp")
foreach(header IN LISTS headers)
  file(STRINGS "${SOURCE_DIR}/include/${header}" lines)
  set(number 0)
  foreach(line IN LISTS lines)
    math(EXPR number "${number} + 1")
    string(REGEX REPLACE "//.*$" "" code "${line}")
    # A declaration ends with ; or has = or {; a function has ( before that.
    if(code MATCHES "(^|[ \t])(static|thread_local|extern|inline)[ \t][^(]*[=;{]"
       AND NOT code MATCHES "constexpr|consteval|static const |namespace|extern \"C\"|static_assert")
      string(APPEND errors "  ${header}:${number}: may change and lives for ever: ${line}\n")
    endif()
    if(NOT header MATCHES "^vadose/io/"
       AND code MATCHES "std::(cout|cerr|clog)|(^|[^a-z_n])(printf|puts|putchar|fprintf|vprintf)[ \t]*\\(")
      string(APPEND errors "  ${header}:${number}: writes to a stream: ${line}\n")
    endif()
    if(code MATCHES "(^|[^a-z_])(signal|sigaction|std::raise|abort|_?exit|quick_exit|atexit|at_quick_exit|set_terminate|set_new_handler|setlocale|fesetround|setenv|putenv|srand|chdir|current_path)[ \t]*\\(")
      string(APPEND errors "  ${header}:${number}: acts on the process of the host: ${line}\n")
    endif()
  endforeach()
endforeach()

list(LENGTH headers count)
if(count EQUAL 0)
  string(APPEND errors "  no headers under ${SOURCE_DIR}/include/vadose\n")
endif()
if(errors)
  message(FATAL_ERROR "state or output of the library's own:\n${errors}")
endif()
message(STATUS "${count} headers have no state and no output of their own")
