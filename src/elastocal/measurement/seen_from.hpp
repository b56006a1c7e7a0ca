// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Trajectories in the frame of one of the robot's links. They show the motion of the joints if the
/// root link is free, so that no link stands still in the laboratory.
struct SeenFrom {
  int link = 0;
  /// Trajectories in the frame of `link`, up to a constant pose. NaN for the markers on its own
  /// body, and in frames in which some of these are not seen.
  MarkerTrajectories trajectories;
};

/// Expresses trajectories (of the robot's markers `markers`) in the frame of the body nearest to
/// the root whose markers tell its pose (TellPose). Nothing if there is no such body, or if it
/// carries all markers.
std::optional<SeenFrom> SeeFromMarkedBody(const MarkedRobot& robot, const std::vector<int>& markers,
                                          const MarkerTrajectories& trajectories);

}  // namespace elastocal
