# SPDX-License-Identifier: Apache-2.0
# The target `api-reference`: the headers as HTML by Doxygen, where it is installed. A warning is an
# error.
find_package(Doxygen QUIET)
if(DOXYGEN_FOUND)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(api-reference COMMAND Doxygen::doxygen ${PROJECT_BINARY_DIR}/Doxyfile
    COMMENT "Writing the API reference to api-reference/html" VERBATIM)
endif()
