# SPDX-License-Identifier: Apache-2.0
# Fails on an #include that the layers do not allow, naming the file and what it includes.
#   cmake -DRULES=FILE -DSOURCES=FOLDER -P check_layers.cmake
# FILE has one line `layer: used layers` for each layer, every layer below those that use it;
# FOLDER has one folder for each layer. A layer may include itself and what it uses, transitively;
# its tests may also include the helpers in tests/.
cmake_minimum_required(VERSION 3.25)

if(NOT RULES OR NOT IS_DIRECTORY "${SOURCES}")
  message(FATAL_ERROR "usage: cmake -DRULES=FILE -DSOURCES=FOLDER -P check_layers.cmake")
endif()

set(unrestricted cli)  # the program may include everything
set(ipopt_layer nlp)  # the only layer that may include Ipopt

set(layers "")
file(STRINGS "${RULES}" lines)
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([a-z_]+):(.*)$" matched "${line}")
  set(layer ${CMAKE_MATCH_1})
  separate_arguments(uses UNIX_COMMAND "${CMAKE_MATCH_2}")
  set(allowed_${layer} ${layer})
  foreach(used IN LISTS uses)
    if(NOT used IN_LIST layers)
      message(FATAL_ERROR "${RULES}: ${layer} uses ${used}, which is no layer above it in the list")
    endif()
    list(APPEND allowed_${layer} ${allowed_${used}})
  endforeach()
  list(APPEND layers ${layer})
endforeach()
set(allowed_${unrestricted} ${unrestricted} ${layers})
set(allowed_mpi "")  # the module that the program loads under mpirun uses nothing
# The umbrella headers beside the layers: what they may include is what their component has.
set(allowed_elastocal.hpp ${allowed_exports})
set(allowed_planning.hpp ${allowed_planning})

set(violations 0)
macro(report what)
  message(NOTICE "${where}: ${what}")
  math(EXPR violations "${violations} + 1")
endmacro()

file(GLOB_RECURSE files RELATIVE "${SOURCES}" "${SOURCES}/*.hpp" "${SOURCES}/*.cpp")
if(NOT files)
  message(FATAL_ERROR "${SOURCES}: no sources")
endif()
foreach(file IN LISTS files)
  string(REGEX REPLACE "/.*" "" layer "${file}")
  set(where "${file}")
  if(NOT DEFINED allowed_${layer})
    report("the folder ${layer} is no layer of CMakeLists.txt")
    continue()
  endif()
  file(STRINGS "${SOURCES}/${file}" includes REGEX "^[ \t]*#[ \t]*include")
  foreach(include IN LISTS includes)
    if(NOT include MATCHES "include[ \t]*[<\"]([^>\"]+)[>\"]")
      report("cannot read '${include}'")
      continue()
    endif()
    set(header "${CMAKE_MATCH_1}")
    if(header MATCHES "^(coin/)?Ip[A-Z]" AND NOT layer STREQUAL ipopt_layer)
      report("${layer} may not include ${header}: only ${ipopt_layer} may")
    elseif(header MATCHES "^elastocal/([^/]+)/")
      if(NOT CMAKE_MATCH_1 IN_LIST allowed_${layer})
        report("${layer} may not include ${header}")
      endif()
    elseif(include MATCHES "\"" AND NOT (file MATCHES "_test\\.cpp$" AND header MATCHES "^tests/"))
      report("write ${header} as elastocal/<layer>/<file>")
    endif()
  endforeach()
endforeach()

list(LENGTH files count)
if(violations)
  message(FATAL_ERROR "Wrong inclusions: ${violations}, in ${count} files")
endif()
message(NOTICE "No wrong inclusion in ${count} files")
