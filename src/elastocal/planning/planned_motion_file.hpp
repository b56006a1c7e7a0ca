// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A planned motion with its zero-moment points and torques.
struct PlannedMotion {
  JointMotion motion;       ///< with time and support
  Eigen::MatrixXd zmp;      ///< samples x 2: zero-moment point on the floor, m
  Eigen::MatrixXd torques;  ///< samples x coordinates: expected of the motors, N.m or N
};

/// The motion as CSV (docs/formats.md "Motion"): time, a column for each joint that is no mimic
/// joint, support, zmp_x and zmp_y, torque_JOINT. Columns of unknown support or forces are left
/// out.
std::string FormatMotionTable(const RobotTree& tree, const PlannedMotion& planned);

/// Whether a text is such a table of this robot, by its columns and the digits of its numbers
/// (times with four decimals, positions with the shortest twelve). Tables by other programs differ
/// in one of these.
bool IsMotionTable(const RobotTree& tree, const std::string& text);

/// Coordinates for a controller: those of joints that carry an end of `chains`, and others that
/// move. Casters, wheels and fingers that do not move are left out.
std::vector<int> CommandedCoordinates(const RobotTree& tree, const std::vector<Chain>& chains,
                                      const JointMotion& motion);

/// Form of time stamps: sec and nanosec (ROS 2), or secs and nsecs (ROS 1).
enum class RosVersion { kRos1, kRos2 };

/// The motion as a ROS trajectory_msgs/JointTrajectory in YAML: positions of the joints
/// `coordinates`, and velocities (central differences), for every `every`-th sample and the last
/// one.
std::string FormatJointTrajectory(const RobotTree& tree, const std::vector<int>& coordinates,
                                  const JointMotion& motion, int every, RosVersion ros);

}  // namespace elastocal
