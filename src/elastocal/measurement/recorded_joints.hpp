// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {

/// Whether a recording holds positions of a coordinate. Otherwise its joint is assumed to stand
/// still at the position that the project gives. For a recording folder: whether any log has them.
inline bool IsRecorded(const Recording& recording, const RobotTree& tree, int coordinate) {
  const auto& absent = recording.joints_not_recorded;
  return std::ranges::find(absent, JointOfCoordinate(tree, coordinate).name) == absent.end();
}

}  // namespace elastocal
