#pragma once

#include <array>
#include <string>
#include <vector>

#include "elastocal/io/project.hpp"

namespace elastocal {

/// Which column of a posture table holds what; columns are counted from 0.
struct PostureColumns {
  std::vector<std::string> names;                  ///< of all columns
  int time = -1;                                   ///< -1 where there is none
  std::vector<int> markers;                        ///< of the project, those with columns
  std::vector<std::array<int, 3>> marker_columns;  ///< x, y, z of each of these
  std::vector<int> coordinate_columns;  ///< for each coordinate of the tree; -1 where there is none
};

/// Finds out what the columns of a header mean. Throws InputError beginning with `place`: unknown
/// and twice given names, a marker without all of its columns, no marker, a joint that moves a
/// recorded marker and has neither a column nor a position in the project.
PostureColumns FindPostureColumns(const std::vector<std::string>& header, const std::string& place,
                                  const Project& project);

/// The column of a joint: as the project has it, or the joint's name.
std::string JointColumn(const Project& project, const std::string& joint);

/// The columns of a marker: as the project has them, or the default ones.
std::array<std::string, 3> MarkerColumns(const Project& project, const std::string& marker);

/// Default columns of a marker: NAME_x, NAME_y, NAME_z.
std::array<std::string, 3> DefaultMarkerColumns(const std::string& marker);

}  // namespace elastocal
