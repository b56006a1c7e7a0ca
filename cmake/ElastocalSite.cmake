# SPDX-License-Identifier: Apache-2.0
# The target `site`: the documentation as pages that need no network, in site/html, where Sphinx with MyST and Furo,
# KaTeX and Doxygen are installed (scripts/setup --dev). A warning, such as a link that leads nowhere, is an error.
find_program(ELASTOCAL_SPHINX sphinx-build)
find_path(ELASTOCAL_KATEX katex.min.js PATHS /usr/share/javascript/katex NO_DEFAULT_PATH)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(ELASTOCAL_SPHINX AND ELASTOCAL_KATEX AND Python3_FOUND AND TARGET api-reference AND ELASTOCAL_PROGRAM)
  set(site ${PROJECT_BINARY_DIR}/site)
  add_custom_target(site
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/site/make_pages.py --source ${PROJECT_SOURCE_DIR}
      --program $<TARGET_FILE:elastocal> --api ${PROJECT_BINARY_DIR}/api-reference/html
      --report ${PROJECT_BINARY_DIR}/tests/complete_chain/report.html --katex ${ELASTOCAL_KATEX} ${site}/pages
    COMMAND ${ELASTOCAL_SPHINX} -W --keep-going -q -E -b html ${site}/pages ${site}/html
    COMMENT "Writing the documentation to site/html/index.html" VERBATIM)
  add_dependencies(site elastocal api-reference)
endif()
