// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace elastocal {

/// The numbers between two bounds. A bound belongs to the range only if `with_lower` (`with_upper`)
/// says so. Infinity belongs to it if it is an upper bound that belongs to the range, or if
/// `or_infinity` is set beside a finite upper bound; files write it as `.inf`.
struct NumberRange {
  double lower, upper = std::numeric_limits<double>::infinity();
  bool with_lower = false, with_upper = false, or_infinity = false;

  bool Contains(double number) const;
  std::string InWords() const;  ///< "a number from 0 to 1"
};

/// Bounds of a number in an input. They are wide: a number beyond them is a slip of the hand and
/// belongs to no robot or experiment; it would take hours or all memory, or overflow.
struct Bound {
  /// Keys of a YAML file from its root with dots between, `[]` for an entry of a list and `*` for a
  /// name; "URDF ELEMENT.ATTRIBUTE"; "COMMAND --option".
  std::string key;
  std::string unit;
  double least, largest;  ///< both are allowed
  const char* why;
  bool or_infinity = false;

  NumberRange range() const { return {least, largest, true, true, or_infinity}; }
};

/// The table of all bounds, which readers check and docs/formats.md shows.
const std::vector<Bound>& AllBounds();

/// The entry of a key, which may have indices and names instead of `[]` and `*`; null if there is
/// none.
const Bound* FindBound(const std::string& key);

/// The range of a key. Throws std::invalid_argument for a key without an entry.
NumberRange BoundsOf(const std::string& key);

/// The table of all bounds in Markdown.
std::string BoundsTable();

}  // namespace elastocal
