# SPDX-License-Identifier: Apache-2.0
# Fails on a source without its line `SPDX-License-Identifier: ...` among the first two.
#   cmake -DSOURCE=FOLDER -P check_licences.cmake
# FOLDER is the repository, or any folder with sources; what it builds is left out.
cmake_minimum_required(VERSION 3.25)

file(GLOB_RECURSE files LIST_DIRECTORIES false RELATIVE "${SOURCE}" "${SOURCE}/*.hpp" "${SOURCE}/*.cpp"
  "${SOURCE}/*.h" "${SOURCE}/*.c" "${SOURCE}/*.py" "${SOURCE}/*.pyi" "${SOURCE}/*.js" "${SOURCE}/*.mjs"
  "${SOURCE}/*.css" "${SOURCE}/*.cmake" "${SOURCE}/*.cmake.in" "${SOURCE}/CMakeLists.txt" "${SOURCE}/scripts/*"
  "${SOURCE}/.ci/*")
list(FILTER files EXCLUDE REGEX "^(build|out|elastocal_demo|web/node_modules|web/dist|scripts/__pycache__)/")
set(missing 0)
foreach(file IN LISTS files)
  file(STRINGS "${SOURCE}/${file}" lines LIMIT_COUNT 2)
  if(NOT lines MATCHES "SPDX-License-Identifier: Apache-2\\.0")
    message(NOTICE "${file}: no line 'SPDX-License-Identifier: Apache-2.0'")
    math(EXPR missing "${missing} + 1")
  endif()
endforeach()
list(LENGTH files count)
if(missing OR NOT count)
  message(FATAL_ERROR "Sources without a licence: ${missing}, of ${count}")
endif()
message(NOTICE "A licence in each of ${count} sources")
