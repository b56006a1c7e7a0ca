// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A link that stands still in a trial, as the experiment says, and moves.
struct MovedSupport {
  int link = 0;           ///< 0: the root link, which is held
  double distance = 0.0;  ///< the furthest of its markers from where they mostly are, m
  int still = -1;         ///< another link at the end of a chain that does stand still; -1: none
  bool labels = false;    ///< whether joints move `still` rather than `link`: labels are exchanged
};

/// A support of the trial that is more than 20 mm from where it mostly is in more than a quarter of
/// the frames in which it is seen: further than a foot slips. Three feet and more are taken
/// for balls: of each, that point near the link's origin counts about which its body turns.
/// `markers`: of the robot, one for each of the trajectories. `travel`: of each joint of the tree,
/// by its log, rad or m.
std::optional<MovedSupport> FindMovedSupport(const RobotTree& tree,
                                             const std::vector<Marker>& markers, const Trial& trial,
                                             const MarkerTrajectories& trajectories,
                                             const Eigen::VectorXd& travel);

/// "the support right_sole_link moves by 312 mm, while left_sole_link stands still", or that the
/// labels of their clusters are exchanged.
std::string Describe(const MovedSupport& moved, const MarkedRobot& robot);

}  // namespace elastocal
