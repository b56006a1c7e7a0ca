// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/project/project.hpp"
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

/// The coordinates that a controller is told: those of joints that carry a tip of `chains`, and
/// others that move. Casters, wheels and fingers that nothing moves are none.
std::vector<int> CommandedCoordinates(const RobotTree& tree, const std::vector<Chain>& chains,
                                      const JointMotion& motion);

/// How stamps are written: sec and nanosec (ROS 2), or secs and nsecs (ROS 1).
enum class RosVersion { kRos1, kRos2 };

/// As a ROS trajectory_msgs/JointTrajectory in YAML: positions of the joints `coordinates` and
/// velocities (central differences), every `every`-th sample and the last one.
std::string FormatJointTrajectory(const RobotTree& tree, const std::vector<int>& coordinates,
                                  const JointMotion& motion, int every, RosVersion ros);

}  // namespace elastocal
