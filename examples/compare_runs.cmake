# SPDX-License-Identifier: MIT
# A run in one go and the same in two halves, the second taken up from the checkpoint of the first, must agree:
# every row of the histories and, byte for byte, the last state of the solid points.
#   cmake -Dprogram=... -Dbase=... -Dend=... -Dhalf=... -Dframes=... "-Dflags=..." -Doutput=... -P compare_runs.cmake
# base: first part of the files' names; end, half: times [s]; frames: states of the whole run, an even number.
cmake_minimum_required(VERSION 3.24)

function(run folder)
  execute_process(COMMAND "${program}" ${flags} --output "${folder}" ${ARGN} RESULT_VARIABLE status
                  OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${program} ${flags} ${ARGN} ended with ${status}:\n${said}")
  endif()
endfunction()

separate_arguments(flags UNIX_COMMAND "${flags}")
math(EXPR half_frames "${frames} / 2")
file(REMOVE_RECURSE "${output}")
run("${output}/whole" --end-time ${end} --frames ${frames})
run("${output}/halves" --end-time ${half} --frames ${half_frames})
run("${output}/halves" --end-time ${end} --frames ${frames} --resume)

file(GLOB histories RELATIVE "${output}/whole" "${output}/whole/${base}_*.csv")
if(NOT histories)
  message(FATAL_ERROR "no histories in ${output}/whole")
endif()
foreach(history IN LISTS histories)
  string(REPLACE ".csv" "_from_${half}s.csv" later "${history}")
  file(STRINGS "${output}/whole/${history}" whole)
  file(STRINGS "${output}/halves/${later}" second)
  list(POP_FRONT second) # the head
  foreach(row IN LISTS second)
    if(NOT row IN_LIST whole)
      message(FATAL_ERROR "a row of ${later} is not in ${history} of the whole run:\n${row}")
    endif()
  endforeach()
  list(LENGTH second rows)
  message(STATUS "${history}: ${rows} rows agree")
endforeach()

file(GLOB states RELATIVE "${output}/whole" "${output}/whole/${base}_solid_*.vtp")
list(SORT states)
list(GET states -1 last)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files "${output}/whole/${last}" "${output}/halves/${last}"
                RESULT_VARIABLE differs)
if(differs)
  message(FATAL_ERROR "${last} of the two runs differ")
endif()
message(STATUS "${last}: the same bytes")
