// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// State of the robot at a sample of a motion that rests before its first and after its last
/// sample. Speeds and accelerations are central differences over `step` seconds.
RobotState StateAt(const Eigen::MatrixXd& q, const std::vector<Transform>& T_world_root,
                   double step, Eigen::Index sample);

/// Zero-moment point of every sample, samples x 2, m.
Eigen::MatrixX2d ZeroMomentPoints(const StandingRobot& robot, const Eigen::MatrixXd& q,
                                  const std::vector<Transform>& T_world_root, double step);

}  // namespace elastocal
