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

/// A link that moves in a trial, although the experiment says that it stands still.
struct MovedSupport {
  int link = 0;           ///< 0: the root link, which is held
  double distance = 0.0;  ///< largest distance of its markers from their usual positions, m
  int still = -1;         ///< another link at the end of a chain that stands still; -1: none
  /// Whether the labels of `link` and `still` seem to be exchanged: the joints that move only
  /// `still` travel 1.5 times as far as those that move only `link`.
  bool labels = false;
};

/// Finds the first support of the trial that moves further than a foot slips: in more than a
/// quarter of the frames in which it is seen, it is more than 20 mm from its usual (median)
/// position. If the trial has three or more supports, they are taken for balls: of each, the point
/// near the link's origin counts about which its body turns. Up to about 500 frames are looked at,
/// and at least 10 must show the support. Nothing if the root link is free.
///
/// `markers` are the robot's markers, one for each of the trajectories. `travel` is how far each
/// joint of the tree moves by its log, rad or m.
std::optional<MovedSupport> FindMovedSupport(const RobotTree& tree,
                                             const std::vector<Marker>& markers, const Trial& trial,
                                             const MarkerTrajectories& trajectories,
                                             const Eigen::VectorXd& travel);

/// "the support right_sole_link moves by 312 mm, while left_sole_link stands still", or that the
/// labels of their clusters are exchanged.
std::string Describe(const MovedSupport& moved, const MarkedRobot& robot);

}  // namespace elastocal
