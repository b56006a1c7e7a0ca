#pragma once

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Standard gravity as most dynamics engines have it, m/s^2; z of the root link up.
inline const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// Torques (forces for prismatic joints) that the motors must supply to hold the robot still, by
/// coordinate of q; N.m or N. `gravity_waist` is the acceleration of gravity in the root link's
/// frame. The load that bends the joints is the opposite.
Eigen::VectorXd GravityTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                               const Eigen::Vector3d& gravity_waist = kGravity);

/// Mass of all links, kg.
double TotalMass(const RobotTree& tree);

}  // namespace elastocal
