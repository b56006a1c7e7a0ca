// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "elastocal/tables/text.hpp"

namespace elastocal {

/// Reads the numbers of a text whose separator is not a comma. Either all have decimal points, or
/// all have decimal commas, as programs write them in some countries. The first such number
/// decides.
class DecimalNumbers {
 public:
  /// A finite number as the file writes them.
  std::optional<double> Parse(std::string_view cell) {
    const std::size_t mark = cell.find_first_of(".,");
    const bool comma = mark != std::string_view::npos && cell[mark] == ',';
    std::string changed;
    if (comma) cell = changed.assign(cell).replace(mark, 1, ".");
    const std::optional<double> number = ParseNumber(cell);
    if (!number || mark == std::string_view::npos) return number;
    if (mark_ == '\0') mark_ = comma ? ',' : '.';
    return (mark_ == ',') == comma ? number : std::nullopt;
  }

  /// For messages: "a number with a decimal point", or comma.
  std::string expected() const {
    return mark_ == ',' ? "a number with a decimal comma, as others above"
                        : "a number with a decimal point";
  }

 private:
  char mark_ = '\0';  ///< point or comma, when a number has told
};

}  // namespace elastocal
