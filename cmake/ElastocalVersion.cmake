# SPDX-License-Identifier: Apache-2.0
# The version with its commit, as a source of the layer report. It is written at each build, and only
# it is compiled again when the commit changes.
set(version_source ${PROJECT_BINARY_DIR}/program_version.cpp)
set(write_version ${CMAKE_COMMAND} -DOUTPUT=${version_source} -DVERSION=${PROJECT_VERSION}
  -DSOURCE=${PROJECT_SOURCE_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/write_version.cmake)
execute_process(COMMAND ${write_version} COMMAND_ERROR_IS_FATAL ANY)
add_custom_target(elastocal_version COMMAND ${write_version} BYPRODUCTS ${version_source}
  COMMENT "" VERBATIM)
target_sources(elastocal_report PRIVATE ${version_source})
add_dependencies(elastocal_report elastocal_version)
