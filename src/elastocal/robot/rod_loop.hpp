// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

// Geometry of the loop that one rod closes. Used by linkage.cpp.

/// Pose of a rod's `to_link`, and the joints between its links, in the frame of its `from_link`.
struct RodLinks {
  Transform T_from_to = Transform::Identity();
  std::vector<int> joints;                    ///< joints of the linkage that move the anchor
  std::vector<Eigen::Vector3d> axes, points;  ///< their axes, and a point on each
};

/// Places the links of a rod with the linkage's joints at `positions`, rad.
RodLinks PlaceLinks(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                    const Eigen::VectorXd& positions);

/// The crank of a rod: the pin moves on a circle about `middle` in the plane of `e1` and `e2`.
struct Crank {
  Eigen::Vector3d middle, e1, e2;
  double radius;
};

/// The crank of a rod that is no actuator; the pin is at `middle` + radius `e1` with the motor at
/// 0.
Crank CrankOf(const Rod& rod);

/// The rod with the errors of its uncertain quantities; `errors` has one number for each.
Rod WithErrorsOfRod(Rod rod, const double* errors);

/// Closing error of a loop (`gap`: distance of pin and anchor less the rod's length, m) and its
/// derivatives.
struct RodLoop {
  double gap = 0.0;
  double by_motor = 0.0;
  Eigen::RowVectorXd by_joints, by_errors;
};

/// The loop of a rod with its motor at `motor` and the linkage's joints at `positions`.
RodLoop EvaluateLoop(const RobotTree& tree, const Linkage& linkage, const Rod& rod, double motor,
                     const Eigen::VectorXd& positions);

/// The loops of all rods of a linkage.
std::vector<RodLoop> EvaluateLoops(const RobotTree& tree, const Linkage& linkage,
                                   const Eigen::VectorXd& motors, const Eigen::VectorXd& positions);

/// Derivatives of the gaps by the joints, loops x joints; and the gaps, one for each loop, m.
Eigen::MatrixXd ByJoints(const std::vector<RodLoop>& loops);
Eigen::VectorXd GapsOf(const std::vector<RodLoop>& loops);

/// The smallest lever, m/rad (m/m for actuators), of cranks on their rods and of rods on the
/// joints.
double LeastLever(const std::vector<RodLoop>& loops);

/// Position of the motor that closes one loop; nothing if the rod cannot reach.
std::optional<double> MotorOf(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                              const Eigen::VectorXd& positions, double branch);

}  // namespace elastocal
