# SPDX-License-Identifier: Apache-2.0
# CPack runs this on the staged files of the packages: it adds what Debian asks for, and sees to it that the same
# commit gives the same bytes. Times are those of the last commit, or of SOURCE_DATE_EPOCH.
function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(output "${output}" PARENT_SCOPE)
endfunction()

if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  run(git -C ${CPACK_ELASTOCAL_SOURCE} log -1 --format=%ct)
  set(ENV{SOURCE_DATE_EPOCH} ${output})
endif()
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(stage ${CPACK_TEMPORARY_DIRECTORY}/${component})
  set(doc ${stage}/usr/share/doc/${package})
  file(COPY ${CPACK_ELASTOCAL_SOURCE}/packaging/copyright DESTINATION ${doc})
  file(WRITE ${doc}/changelog "elastocal (${CPACK_PACKAGE_VERSION}) bookworm; urgency=medium\n\n"
    "  * Made from the sources of this version.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  run(gzip -9n ${doc}/changelog)
  if(component STREQUAL program)
    run(gzip -9n ${stage}/usr/share/man/man1/elastocal.1)
    file(RENAME ${stage}/usr/share/zsh/site-functions ${stage}/usr/share/zsh/vendor-completions)
    if(EXISTS ${CPACK_ELASTOCAL_NOTICES})
      file(COPY ${CPACK_ELASTOCAL_NOTICES} DESTINATION ${doc})
    endif()
  endif()

  run(chmod -R u=rwX,go=rX ${stage})
  file(GLOB_RECURSE binaries ${stage}/usr/bin/* ${stage}/usr/lib/*.so.* ${stage}/usr/lib/*.so)
  foreach(binary IN LISTS binaries)
    if(NOT IS_SYMLINK ${binary})
      file(RPATH_REMOVE FILE ${binary})  # the system's own folders have the libraries
      if(NOT binary MATCHES "/bin/")
        run(chmod a-x ${binary})
      endif()
    endif()
  endforeach()
  execute_process(COMMAND grep -rlF ${CPACK_ELASTOCAL_SOURCE} ${stage} OUTPUT_VARIABLE found)
  if(found)
    message(FATAL_ERROR "These files name the folder in which they were built:\n${found}")
  endif()
  run(find ${stage} -exec touch -hd "@$ENV{SOURCE_DATE_EPOCH}" {} +)
endforeach()
