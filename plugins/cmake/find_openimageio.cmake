# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
find_package(OpenImageIO REQUIRED)
# Not asked of find_package: OpenImageIO 3 calls itself incompatible with a request for 2.4.
if(OpenImageIO_VERSION VERSION_LESS 2.4)
  message(FATAL_ERROR "OpenImageIO ${OpenImageIO_VERSION} found, 2.4 or later needed")
endif()

# Debian 12's exported target names /usr/include/opencv4, which its dev package does not
# pull in, and CMake refuses targets with an include path that does not exist.
foreach(target OpenImageIO::OpenImageIO OpenImageIO::OpenImageIO_Util)
  foreach(property INTERFACE_INCLUDE_DIRECTORIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES)
    get_target_property(folders ${target} ${property})
    if(folders)
      foreach(folder IN LISTS folders)
        if(IS_ABSOLUTE "${folder}" AND NOT EXISTS "${folder}")
          list(REMOVE_ITEM folders "${folder}")
        endif()
      endforeach()
      set_target_properties(${target} PROPERTIES ${property} "${folders}")
    endif()
  endforeach()
endforeach()
