# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
# Configures, builds and tests the preset asan; run from the root of the source tree.
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(${CMAKE_COMMAND} --preset asan)
run(${CMAKE_COMMAND} --build build/asan)
run(ctest --test-dir build/asan --output-on-failure -E consumer)
