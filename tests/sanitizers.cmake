# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
# Configures, builds and tests the preset asan; run from the root of the source tree.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed (${result}): ${ARGN}\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --preset asan)
run(${CMAKE_COMMAND} --build build/asan)
run(ctest --test-dir build/asan --output-on-failure -E consumer)
