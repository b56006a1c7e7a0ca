// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace elastocal {

/// The numbers between two bounds, without the bounds unless they are said to count. An infinite
/// upper bound that counts, and one beyond a finite one (`or_infinity`), is written as `.inf`.
struct NumberRange {
  double lower, upper = std::numeric_limits<double>::infinity();
  bool with_lower = false, with_upper = false, or_infinity = false;

  bool Contains(double number) const;
  std::string InWords() const;  ///< "a number from 0 to 1"
};

/// What a number in an input may be. Bounds are wide: what is beyond is no robot and no experiment,
/// but a slip of the hand, and would take hours, all memory, or overflow.
struct Bound {
  /// Keys of a YAML file from its root with dots between, `[]` for an entry of a list and `*` for a
  /// name; "URDF ELEMENT.ATTRIBUTE"; "COMMAND --option".
  std::string key;
  std::string unit;
  double least, largest;  ///< both count
  const char* why;
  bool or_infinity = false;

  NumberRange range() const { return {least, largest, true, true, or_infinity}; }
};

/// All of them: the one table that readers check by and that docs/formats.md shows.
const std::vector<Bound>& AllBounds();

/// The entry of a key, in which indices and names may stand instead of `[]` and `*`; null where
/// there is none.
const Bound* FindBound(const std::string& key);

/// The range of a key that has an entry. Throws std::invalid_argument for one that has none.
NumberRange BoundsOf(const std::string& key);

/// The table in Markdown.
std::string BoundsTable();

}  // namespace elastocal
