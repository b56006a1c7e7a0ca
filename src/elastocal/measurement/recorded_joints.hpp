// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {

/// Whether a recording holds the positions of a coordinate; else they are where the project says
/// that the joint stood still. Of a recording folder: whether any log has them.
inline bool IsRecorded(const Recording& recording, const RobotTree& tree, int coordinate) {
  const auto& absent = recording.joints_not_recorded;
  return std::ranges::find(absent, JointOfCoordinate(tree, coordinate).name) == absent.end();
}

}  // namespace elastocal
