# SPDX-License-Identifier: Apache-2.0
# Builds the page of the report (web/) and makes a source of it, so that the program has it in itself.
#
#   ELASTOCAL_PAGE=AUTO  where Node.js 18 or newer and npm are found (default)
#   ELASTOCAL_PAGE=ON    always; without them configuring fails
#   ELASTOCAL_PAGE=OFF   never: `elastocal report` then says what it lacks
set(ELASTOCAL_PAGE AUTO CACHE STRING "Build the report's page: AUTO, ON or OFF")
set_property(CACHE ELASTOCAL_PAGE PROPERTY STRINGS AUTO ON OFF)

find_program(ELASTOCAL_NODE NAMES node nodejs)
find_program(ELASTOCAL_NPM npm)
set(lacking "")
if(NOT ELASTOCAL_NODE OR NOT ELASTOCAL_NPM)
  set(lacking "Node.js or npm is not installed (Debian: nodejs npm)")
else()
  execute_process(COMMAND ${ELASTOCAL_NODE} --version OUTPUT_VARIABLE version
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" version "${version}")
  if(version VERSION_LESS 18)
    set(lacking "Node.js ${version} is older than 18")
  endif()
endif()

set(ELASTOCAL_HAS_PAGE FALSE)
if(ELASTOCAL_PAGE AND NOT lacking)
  set(ELASTOCAL_HAS_PAGE TRUE)
elseif(ELASTOCAL_PAGE STREQUAL "AUTO")
  message(STATUS "No page for reports: ${lacking}")
elseif(ELASTOCAL_PAGE)
  message(FATAL_ERROR "ELASTOCAL_PAGE is ON, but ${lacking}")
endif()

set(page_source ${PROJECT_BINARY_DIR}/page_template.cpp)
set(page_script ${PROJECT_SOURCE_DIR}/cmake/build_page.cmake)
set(web ${PROJECT_SOURCE_DIR}/web)
set(ELASTOCAL_WEB_BUILD ${PROJECT_BINARY_DIR}/web)  # node_modules is there, not among the sources

if(ELASTOCAL_HAS_PAGE)
  file(GLOB_RECURSE page_files CONFIGURE_DEPENDS ${web}/src/* ${web}/test/*)
  add_custom_command(OUTPUT ${ELASTOCAL_WEB_BUILD}/installed
    COMMAND ${CMAKE_COMMAND} -DSTEP=install -DNPM=${ELASTOCAL_NPM} -DWEB=${web}
      -DBUILD=${ELASTOCAL_WEB_BUILD} -P ${page_script}
    DEPENDS ${web}/package.json ${web}/package-lock.json ${web}/.npmrc ${page_script}
    COMMENT "Installing the packages of the report's page" VERBATIM)
  add_custom_command(OUTPUT ${page_source} ${ELASTOCAL_WEB_BUILD}/dist/index.html ${ELASTOCAL_WEB_BUILD}/dist/notices.txt
    COMMAND ${CMAKE_COMMAND} -DSTEP=build -DNODE=${ELASTOCAL_NODE} -DWEB=${web}
      -DBUILD=${ELASTOCAL_WEB_BUILD} -DSOURCE=${page_source} -P ${page_script}
    DEPENDS ${ELASTOCAL_WEB_BUILD}/installed ${page_files} ${web}/index.html ${web}/vite.config.js ${web}/notices.js
    COMMENT "Building the report's page" VERBATIM)
else()
  add_custom_command(OUTPUT ${page_source}
    COMMAND ${CMAKE_COMMAND} -DSTEP=none -DSOURCE=${page_source} -P ${page_script}
    DEPENDS ${page_script} VERBATIM)
endif()
