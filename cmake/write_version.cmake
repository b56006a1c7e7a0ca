# SPDX-License-Identifier: Apache-2.0
# Writes the source OUTPUT, which defines elastocal::ProgramVersion() (report/version.hpp), from VERSION
# and the commit of the repository SOURCE. The file is touched only when its text changes.
set(commit unknown)
find_program(git git)
if(git)
  # SOURCE itself must be the repository: a released source may lie in a folder of another one.
  execute_process(COMMAND ${git} rev-parse --show-toplevel WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH ${SOURCE} source)
  if(top)
    file(REAL_PATH ${top} top)
  endif()
  if(top STREQUAL source)
    execute_process(COMMAND ${git} describe --always --dirty=+ WORKING_DIRECTORY ${SOURCE}
      OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(NOT failed)
      set(commit ${described})
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include "elastocal/report/version.hpp"

namespace elastocal {

const char* ProgramVersion() { return "@VERSION@ (@commit@)"; }

}  // namespace elastocal
]] @ONLY)
