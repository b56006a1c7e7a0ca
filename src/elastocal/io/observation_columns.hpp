// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// Where a table of observations has what is read from it: numbers of columns, -1 where it has
/// none.
struct ObservationColumns {
  std::vector<int> coordinates;  // by coordinate of the robot
  std::vector<int> sessions;     // all are there
  std::vector<int> ignored;      // that the project names in recording.ignore
  int plate = -1, frame = -1;
  std::vector<std::vector<int>> instruments;  // of plates, and of those that are absent: empty

  /// Whether an instrument shows something in it.
  bool measures() const;
};

/// Throws InputError for a column that is unknown, for part of an instrument's columns, and for a
/// joint that moves a foot or what is observed and is not known.
ObservationColumns FindObservationColumns(const Table& table, const Project& project);

}  // namespace elastocal
