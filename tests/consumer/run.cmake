# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
# cmake -DBUILD=... -DCONFIG=... -DCOMPILER=... -DSANITIZE=... -P run.cmake
# Installs BUILD into a fresh prefix, builds this project against it, and runs it.
set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})

include(${CMAKE_CURRENT_LIST_DIR}/../run.cmake)

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
foreach(file lib/cg2raw/oiio/dng.imageio.so share/cg2raw/profiles/nikon-d40.json
        include/cg2raw/simulation.h share/man/man1/cg2raw-convert.1)
  if(NOT EXISTS ${work}/prefix/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()

set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=${SANITIZE}")
endif()
run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build
  -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=${CONFIG}
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${flags})
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer ${work}/ramp.dng)
message(STATUS "consumer: ${output}")
if(NOT EXISTS ${work}/ramp.dng)
  message(FATAL_ERROR "${work}/ramp.dng was not written")
endif()
