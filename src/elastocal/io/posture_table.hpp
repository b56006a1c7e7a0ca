// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A recording, with warnings about it that are no reason to refuse it.
struct PostureTable {
  Recording recording;
  std::vector<std::string> markers_not_recorded;  ///< markers of the project without columns
  std::vector<std::string> warnings;              ///< joints beyond their limits, repeated rows
};

/// Reads a table of static postures: CSV with a header row; one row a posture; columns named by the
/// project (default: URDF joint names and NAME_x, NAME_y, NAME_z); m and rad. A marker
/// with cells that are empty or NaN was not seen. Throws InputError naming file, line and column:
/// missing or unknown column (with the nearest known one), text or NaN where a number belongs (NaN
/// in some cells of a marker), no rows, a line above 1 MiB, two markers with identical columns,
/// other units than metres (judged by the robot's size; for one marker by FindOtherUnit), postures
/// that are all the same; a recording over time (RefuseRecording).
PostureTable ReadPostureTable(const std::filesystem::path& file, const Project& project);

/// The same from a stream; `source` names it in messages.
PostureTable ReadPostureTable(std::istream& stream, const std::string& source,
                              const Project& project);

/// Writes a recording as such a table, under the column names of the project.
void WritePostureTable(const std::filesystem::path& file, const Recording& recording,
                       const Project& project);

/// Writes a recording as a posture table, under the default column names.
void WritePostureTable(const std::filesystem::path& file, const Recording& recording,
                       const RobotTree& tree);

}  // namespace elastocal
