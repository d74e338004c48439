# SPDX-License-Identifier: MIT
# Configures, builds and runs a host project in a fresh folder.
#   MODE = find_package (of a copy installed there) or add_subdirectory
#   SOURCE_DIR, BUILD_DIR: this repository and its build; WORK_DIR: the fresh folder
#   CXX_COMPILER, GENERATOR, EIGEN3_DIR: as in BUILD_DIR
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
if(MODE STREQUAL "find_package")
  run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/installed")
  set(where "-Dvadose_ROOT=${WORK_DIR}/installed")
else()
  set(where "-DVADOSE_ROOT=${SOURCE_DIR}")
endif()
run("${CMAKE_COMMAND}"
    -S "${SOURCE_DIR}/tests/consumer/${MODE}"
    -B "${WORK_DIR}/build"
    -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${CXX_COMPILER}"
    "-DEigen3_DIR=${EIGEN3_DIR}"
    -DCMAKE_BUILD_TYPE=Release
    "${where}")
if(MODE STREQUAL "find_package")
  file(STRINGS "${WORK_DIR}/build/CMakeCache.txt" found REGEX "^vadose_DIR:")
  string(FIND "${found}" "=${WORK_DIR}/installed/" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "find_package took another copy: ${found}")
  endif()
endif()
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build" --config Release)
find_program(consumer consumer PATHS "${WORK_DIR}/build" "${WORK_DIR}/build/Release"
             NO_DEFAULT_PATH REQUIRED)
run("${consumer}")
