// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A planned motion with what it will feel like.
struct PlannedMotion {
  JointMotion motion;       ///< with time and support
  Eigen::MatrixXd zmp;      ///< samples x 2: zero-moment point on the floor, m
  Eigen::MatrixXd torques;  ///< samples x coordinates: expected of the motors, N.m or N
};

/// As CSV (docs/formats.md "Motion"): time, a column a joint that is no mimic, support, zmp_x and
/// zmp_y, torque_JOINT. Without support or forces, these columns are left out.
std::string FormatMotionTable(const RobotTree& tree, const PlannedMotion& planned);

/// Whether a text is such a table of this robot, by its columns and the digits of its numbers:
/// times with four decimals, positions with the shortest twelve. Tables of others differ in one of
/// them.
bool IsMotionTable(const RobotTree& tree, const std::string& text);

/// As a ROS trajectory_msgs/JointTrajectory in YAML: positions of all joints that are no mimics and
/// velocities (central differences), every `every`-th sample and the last one.
std::string FormatJointTrajectory(const RobotTree& tree, const JointMotion& motion, int every);

}  // namespace elastocal
