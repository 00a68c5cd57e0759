# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
# run(command ...): its output in the variable output; a failure ends the test and shows it.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed (${result}): ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
