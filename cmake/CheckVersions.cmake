# SPDX-License-Identifier: MIT
# The version is the same in CMakeLists.txt, vadose.hpp, CITATION.cff and CHANGELOG.md, and that which
# README.md tells hosts to ask for fits it.
#   cmake -D SOURCE_DIR=<repository> -P cmake/CheckVersions.cmake
cmake_minimum_required(VERSION 3.25)

# version_in(<file> <regular expression with the version in group 1>)
function(version_in file pattern)
  file(READ "${SOURCE_DIR}/${file}" text)
  if(NOT "\n${text}" MATCHES "${pattern}")
    message(FATAL_ERROR "${file}: no version found")
  endif()
  set(version "${CMAKE_MATCH_1}")
  message(STATUS "${file}: ${version}")
  if(NOT version STREQUAL expected)
    message(FATAL_ERROR "${file} says ${version}, vadose.hpp says ${expected}")
  endif()
endfunction()

set(expected "")
file(READ "${SOURCE_DIR}/include/vadose/vadose.hpp" umbrella)
foreach(part IN ITEMS MAJOR MINOR PATCH)
  if(NOT umbrella MATCHES "\n#define VADOSE_VERSION_${part} ([0-9]+)\n")
    message(FATAL_ERROR "vadose.hpp: VADOSE_VERSION_${part} is missing")
  endif()
  list(APPEND expected ${CMAKE_MATCH_1})
endforeach()
list(JOIN expected "." expected)

set(number "([0-9]+\\.[0-9]+\\.[0-9]+)")
version_in(CMakeLists.txt "\n *VERSION ${number}\n")
version_in(CITATION.cff "\nversion: \"?${number}")
version_in(CHANGELOG.md "\n## \\[${number}\\]")  # the newest entry comes first

string(REGEX REPLACE "\\.[0-9]+$" "" asked "${expected}")
file(READ "${SOURCE_DIR}/README.md" readme)
if(NOT readme MATCHES "find_package\\(vadose ([0-9.]+) REQUIRED\\)" OR NOT CMAKE_MATCH_1 STREQUAL asked)
  message(FATAL_ERROR "README.md asks for version ${CMAKE_MATCH_1}, vadose.hpp says ${expected}")
endif()
file(READ "${SOURCE_DIR}/CITATION.cff" citation)
file(READ "${SOURCE_DIR}/LICENSE" license)
if(NOT citation MATCHES "\nlicense: MIT\n" OR NOT license MATCHES "^MIT License")
  message(FATAL_ERROR "LICENSE and the license of CITATION.cff are not both MIT")
endif()
