// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {

/// Mass properties of a body (of all its links together), in the body's frame.
struct BodyInertia {
  double mass = 0.0;                                  ///< kg
  Eigen::Vector3d com = Eigen::Vector3d::Zero();      ///< m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre of mass, kg.m^2
};

/// Mass properties of each body of the tree.
std::vector<BodyInertia> BodyInertias(const RobotTree& tree);

/// A robot in motion. The root link floats in the world. All vectors are in the world's axes.
struct RobotState {
  Transform T_world_root = Transform::Identity();
  Eigen::Vector3d root_velocity = Eigen::Vector3d::Zero();      ///< of the root's origin, m/s
  Eigen::Vector3d root_turn = Eigen::Vector3d::Zero();          ///< angular velocity, rad/s
  Eigen::Vector3d root_acceleration = Eigen::Vector3d::Zero();  ///< of the root's origin, m/s^2
  Eigen::Vector3d root_turn_rate = Eigen::Vector3d::Zero();     ///< angular acceleration, rad/s^2
  Eigen::VectorXd q, velocity, acceleration;  ///< by coordinate; rad or m, per s, per s^2
};

/// Force and moment on a link, in the world's axes; the moment is about the world's origin.
struct LinkWrench {
  int link = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< N.m
};

struct InverseDynamicsResult {
  /// Torque that the motors supply, for each coordinate, N.m or N. The torque of a mimic joint is
  /// added to the coordinate that drives it, times its multiplier.
  Eigen::VectorXd torques;
  /// The force and moment on the robot, besides gravity and the given wrenches, that its motion
  /// needs; without given wrenches, this is what the floor exerts. In the world's axes, the moment
  /// about the world's origin.
  Eigen::Vector3d force, moment;
  Eigen::Vector3d com;  ///< of the whole robot in the world, m
};

/// Inverse dynamics of the floating tree (recursive Newton-Euler): torques and floor's wrench for a
/// given motion. `inertias` is what BodyInertias returns; `gravity` is in the world, m/s^2;
/// `wrenches` act on links, for instance on feet on the floor.
InverseDynamicsResult InverseDynamics(const RobotTree& tree,
                                      const std::vector<BodyInertia>& inertias,
                                      const RobotState& state, const Eigen::Vector3d& gravity,
                                      const std::vector<LinkWrench>& wrenches = {});

/// Centre of mass in the root link's frame, m.
Eigen::Vector3d CentreOfMass(const RobotTree& tree, const std::vector<BodyInertia>& inertias,
                             const Eigen::VectorXd& q);

}  // namespace elastocal
