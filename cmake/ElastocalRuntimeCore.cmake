# SPDX-License-Identifier: Apache-2.0
# The run-time core as text, for the headers that `elastocal export` writes.
set(core_text "/* SPDX-License-Identifier: Apache-2.0 */\n")
foreach(part poses motion statics equations step reach ease follow input correction)
  set(file ${PROJECT_SOURCE_DIR}/src/elastocal/runtime/core_${part}.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(REGEX REPLACE "#include \"elastocal/[^\n]*\n\n?" "" text "${text}")
  string(REGEX REPLACE "^/\\* SPDX[^\n]*\n" "" text "${text}")
  string(APPEND core_text "${text}\n")
endforeach()
# A string literal has a length that every compiler takes: pieces, which the compiler joins.
string(REPLACE "\n/* " ")CORE\"\nR\"CORE(\n/* " core_text "${core_text}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/runtime_core_text.cpp CONTENT [[
#include "elastocal/runtime/c_header.hpp"

// Longer than every compiler has to take; gcc and clang do.
#pragma GCC diagnostic ignored "-Woverlength-strings"

namespace elastocal {

const char* const kRuntimeCore = R"CORE(@core_text@)CORE";

}  // namespace elastocal
]] @ONLY)
target_sources(elastocal_runtime PRIVATE ${PROJECT_BINARY_DIR}/runtime_core_text.cpp)
