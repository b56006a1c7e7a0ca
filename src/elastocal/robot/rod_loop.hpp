// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

// The loop that a rod closes, by geometry alone: what linkage.cpp is made of.

/// Where the links of a rod are with the joints somewhere: in the frame of `from_link`.
struct RodLinks {
  Transform T_from_to = Transform::Identity();
  std::vector<int> joints;                    ///< of the linkage, that move the anchor
  std::vector<Eigen::Vector3d> axes, points;  ///< of these
};

RodLinks PlaceLinks(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                    const Eigen::VectorXd& positions);

/// The crank of a rod: the pin goes round `middle` in the plane of `e1` and `e2`.
struct Crank {
  Eigen::Vector3d middle, e1, e2;
  double radius;
};

Crank CrankOf(const Rod& rod);

/// The rod with errors of its uncertain quantities, as many numbers.
Rod WithErrorsOfRod(Rod rod, const double* errors);

/// A loop that is to be closed: distance of pin and anchor less the rod's length, m.
struct RodLoop {
  double gap = 0.0;
  double by_motor = 0.0;
  Eigen::RowVectorXd by_joints, by_errors;
};

RodLoop EvaluateLoop(const RobotTree& tree, const Linkage& linkage, const Rod& rod, double motor,
                     const Eigen::VectorXd& positions);

/// By rod.
std::vector<RodLoop> EvaluateLoops(const RobotTree& tree, const Linkage& linkage,
                                   const Eigen::VectorXd& motors, const Eigen::VectorXd& positions);

Eigen::MatrixXd ByJoints(const std::vector<RodLoop>& loops);
Eigen::VectorXd GapsOf(const std::vector<RodLoop>& loops);

/// The least lever, m: of the cranks on their rods, and of the rods on the joints.
double LeastLever(const std::vector<RodLoop>& loops);

/// Position of the motor that closes one loop; nothing where the rod cannot reach.
std::optional<double> MotorOf(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                              const Eigen::VectorXd& positions, double branch);

}  // namespace elastocal
