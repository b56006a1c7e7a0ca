// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <string>

namespace elastocal {

/// A number with all its digits, as printf("%.17g") writes it in the locale "C". The locale of the
/// process, which may have decimal commas, does not matter.
inline std::string NumberText(double value) {
  char text[40];
  const std::to_chars_result end =
      std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17);
  return std::string(text, end.ptr);
}

}  // namespace elastocal
