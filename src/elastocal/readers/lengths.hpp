// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// Metres in a unit that files name: mm, cm, m, in and the long names, whatever the letters' case;
/// 0 for anything else.
double MetresIn(std::string_view unit);

/// The unit that a file states, or the one that the user gives. Throws InputError naming `source`
/// where nobody says, where the name is unknown, or where the two differ.
double UnitOf(std::string_view stated, const std::string& given, const std::string& source);

}  // namespace elastocal
