# SPDX-License-Identifier: MIT
# Helpers for the tests, examples and benchmarks of this repository. Nothing here reaches a host.
include(CheckCXXCompilerFlag)
find_package(OpenMP QUIET COMPONENTS CXX)
check_cxx_compiler_flag("${VADOSE_NATIVE_FLAGS}" VADOSE_HAS_NATIVE_FLAGS)
set(CMAKE_CXX_EXTENSIONS OFF)

# Warnings as usage requirements, so that header checks get them too.
add_library(vadose_warnings INTERFACE)
target_compile_options(
  vadose_warnings
  INTERFACE -Wall
            -Wextra
            -Wpedantic
            -Wshadow
            -Wconversion
            -Wold-style-cast
            -Wnon-virtual-dtor
            $<$<BOOL:${VADOSE_WERROR}>:-Werror>)

# vadose_own_target(<target> [NATIVE]): library, warnings, recommended floating-point flags and,
# where found, OpenMP. NATIVE compiles for this processor if VADOSE_NATIVE is on.
function(vadose_own_target target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "NATIVE" "" "")
  target_link_libraries(${target} PRIVATE vadose::vadose vadose_warnings)
  target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math)
  target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}")
  if(TARGET OpenMP::OpenMP_CXX)
    target_link_libraries(${target} PRIVATE OpenMP::OpenMP_CXX)
  endif()
  if(arg_NATIVE AND VADOSE_NATIVE AND VADOSE_HAS_NATIVE_FLAGS)
    target_compile_options(${target} PRIVATE ${VADOSE_NATIVE_FLAGS})
  endif()
endfunction()
