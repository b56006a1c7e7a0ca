// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// Columns of a table of observations, as indices; -1: there is none.
struct ObservationColumns {
  std::vector<int> coordinates;  // by coordinate of the robot
  std::vector<int> sessions;     // one for each of SessionRule::columns
  std::vector<int> ignored;      // columns that the project names in recording.ignore
  int plate = -1, frame = -1;
  std::vector<std::vector<int>> instruments;  // by instrument; empty: plates, absent ones

  /// Whether the table has measurements of an instrument other than a plate.
  bool measures() const;
};

/// Finds the columns. Throws InputError for an unknown column, for an instrument with only some of
/// its columns, and for a joint that moves a foot or what is observed and has neither a column nor
/// a position in the project.
ObservationColumns FindObservationColumns(const Table& table, const Project& project);

}  // namespace elastocal
