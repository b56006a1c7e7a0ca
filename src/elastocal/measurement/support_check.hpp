// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A link that stands still in a trial, as the experiment says, and moves.
struct MovedSupport {
  int link = 0;           ///< 0: the root link, which is held
  double distance = 0.0;  ///< the furthest of its markers from where they mostly are, m
  int still = -1;         ///< another link at the end of a chain that does stand still; -1: none
};

/// A support of the trial that is more than 20 mm from where it mostly is in more than a quarter of
/// the frames in which it is seen: further than a foot slips. Three feet and more are taken
/// for balls: of each, that point near the link's origin counts about which its body turns.
/// `markers`: of the robot, one for each of the trajectories.
std::optional<MovedSupport> FindMovedSupport(const RobotTree& tree,
                                             const std::vector<Marker>& markers, const Trial& trial,
                                             const MarkerTrajectories& trajectories);

/// "the support right_sole_link moves by 312 mm, while left_sole_link stands still".
std::string Describe(const MovedSupport& moved, const RobotTree& tree);

}  // namespace elastocal
