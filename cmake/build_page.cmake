# SPDX-License-Identifier: Apache-2.0
# The steps of ElastocalPage.cmake.
#   STEP=install  WEB, BUILD, NPM: the packages of package-lock.json into BUILD/node_modules
#   STEP=build    WEB, BUILD, NODE, SOURCE: the page, and a C++ source with it
#   STEP=none     SOURCE: a C++ source that says that there is no page
cmake_minimum_required(VERSION 3.25)

function(write_source text)
  # Raw strings of less than 16 kB, which every compiler takes; their end mark is not in the page.
  set(literals "")
  string(LENGTH "${text}" length)
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${text}" ${at} 15000 piece)
    string(APPEND literals "    R\"~page~(${piece})~page~\"\n")
    math(EXPR at "${at} + 15000")
  endwhile()
  if(literals STREQUAL "")
    set(literals "    \"\"\n")
  endif()
  file(WRITE ${SOURCE} "// Made by cmake/build_page.cmake.\n#include \"elastocal/report/page.hpp\"\n\n"
    "namespace elastocal {\n\nstd::string_view PageTemplate() {\n  return\n${literals}    ;\n}\n\n"
    "}  // namespace elastocal\n")
endfunction()

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE status
    OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${output}\n${command}: failed (${status}). "
      "Configure with -DELASTOCAL_PAGE=OFF to build without the report's page.")
  endif()
endfunction()

if(STEP STREQUAL "install")
  file(MAKE_DIRECTORY ${BUILD})
  foreach(file package.json package-lock.json .npmrc)
    file(COPY ${WEB}/${file} DESTINATION ${BUILD})
  endforeach()
  run(${NPM} ci --no-audit --no-fund --prefer-offline)
  file(TOUCH ${BUILD}/installed)
elseif(STEP STREQUAL "build")
  file(REMOVE_RECURSE ${BUILD}/src ${BUILD}/test)
  file(COPY ${WEB}/src ${WEB}/index.html ${WEB}/vite.config.js ${WEB}/notices.js ${WEB}/test ${WEB}/../LICENSE
    DESTINATION ${BUILD})
  run(${NODE} node_modules/vite/bin/vite.js build --logLevel warn)
  file(READ ${BUILD}/dist/index.html page)
  write_source("${page}")
else()
  write_source("")
endif()
