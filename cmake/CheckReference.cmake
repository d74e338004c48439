# SPDX-License-Identifier: MIT
# Doxygen reads every public comment without a warning.
#   cmake -D SOURCE_DIR=<repository> -D DOXYGEN=<program> -D WORK_DIR=<folder> -P cmake/CheckReference.cmake
cmake_minimum_required(VERSION 3.25)

file(READ "${SOURCE_DIR}/cmake/Doxyfile" text)
string(APPEND text "\nOUTPUT_DIRECTORY = \"${WORK_DIR}\"\nGENERATE_HTML = NO\n"
       "GENERATE_TAGFILE = \"${WORK_DIR}/vadose.tag\"\n")
file(MAKE_DIRECTORY "${WORK_DIR}")
file(WRITE "${WORK_DIR}/Doxyfile" "${text}")
execute_process(
  COMMAND "${DOXYGEN}" "${WORK_DIR}/Doxyfile" WORKING_DIRECTORY "${SOURCE_DIR}"
  OUTPUT_QUIET ERROR_VARIABLE warnings RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT warnings STREQUAL "")
  message(FATAL_ERROR "doxygen (status ${result}) says:\n${warnings}")
endif()
file(STRINGS "${WORK_DIR}/vadose.tag" entries REGEX "<compound ")
list(LENGTH entries count)
if(count LESS 100)
  message(FATAL_ERROR "only ${count} entries: the headers were not found")
endif()
message(STATUS "${count} classes, files and namespaces without a warning")
