// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// Metres in a unit that files name: mm, cm, m, in and the long names, in small or capital letters;
/// 0 for any other text.
double MetresIn(std::string_view unit);

/// Metres in the unit that a file states (`stated`) or that the user gives (`given`). Throws
/// InputError naming `source` if there is neither, if the name is unknown, or if the two differ.
double UnitOf(std::string_view stated, const std::string& given, const std::string& source);

}  // namespace elastocal
