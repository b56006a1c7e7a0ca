// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Where the root link is free, nothing of the robot stands still in the laboratory. What its
/// joints do is seen from a link instead.
struct SeenFrom {
  int link = 0;
  /// In the frame of `link`, up to a constant pose. NaN for the markers on its own body, and in
  /// frames in which some of these are not seen.
  MarkerTrajectories trajectories;
};

/// The trajectories (of the robot's markers `markers`) as seen from the body nearest to the root
/// that carries three of them which tell its pose. Nothing if there is no such body, or no marker
/// elsewhere.
std::optional<SeenFrom> SeeFromMarkedBody(const MarkedRobot& robot, const std::vector<int>& markers,
                                          const MarkerTrajectories& trajectories);

}  // namespace elastocal
