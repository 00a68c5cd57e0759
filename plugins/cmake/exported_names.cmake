# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
#
# exported_names(<variable> <exports.map>): what a version script of GNU ld exports, for
# those who cannot read one.
function(exported_names variable map)
  file(STRINGS ${map} lines REGEX "^ +[a-z_]+;$")
  set(names "")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "[ ;]" "" name "${line}")
    list(APPEND names ${name})
  endforeach()
  set(${variable} ${names} PARENT_SCOPE)
endfunction()
