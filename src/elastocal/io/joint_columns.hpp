#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "elastocal/io/project.hpp"

namespace elastocal {

/// Which column of a joint log holds what; columns are counted from 0.
struct JointColumns {
  std::vector<std::string> names;  ///< of all columns
  int time = -1;
  std::vector<int> joints;     ///< of the tree, those with positions, in the order of these columns
  std::vector<int> positions;  ///< column of each of these
  std::vector<int> torques;    ///< column of each of these; -1 where there is none
  std::vector<int> wrench_sensors;           ///< of Project::force_torque_sensors
  std::vector<std::array<int, 6>> wrenches;  ///< columns of each of these: fx, ..., tz
};

/// Finds out what the columns of a header mean. Throws InputError beginning with `place`: unknown
/// columns, columns that say the same twice, no time, no joint, torques of a joint without
/// positions, only some of the columns of a force-torque sensor.
JointColumns FindJointColumns(const std::vector<std::string>& header, const std::string& place,
                              const Project& project);

}  // namespace elastocal
