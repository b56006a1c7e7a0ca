// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Changes the positions of a linkage's motors (rad; actuators m) in a posture q by `change`, and
/// sets its joints in q to where the nominal rods then put them. Returns false and leaves q as it
/// is if the linkage does not close before or after the change.
bool MoveMotors(const RobotTree& tree, const Linkage& linkage,
                const std::function<void(Eigen::VectorXd& motors)>& change, Eigen::VectorXd& q);

/// Whose positions a log holds: a joint's or a motor's.
struct LoggedPosition {
  std::string name;     ///< of the joint or motor
  bool slides = false;  ///< whether its positions are in m, not in rad
};
/// The joint that entry `entry` of q stands for (`linkage` -1), or the motor of rod `entry` of a
/// linkage.
LoggedPosition LoggedPositionOf(const RobotTree& tree, int linkage, int entry);

/// A motor of the tree's linkages: index of the linkage, and of the rod in it. (-1, -1): none.
struct MotorIndex {
  int linkage = -1, rod = -1;
};
/// The motor with this name.
MotorIndex FindMotor(const RobotTree& tree, const std::string& name);

}  // namespace elastocal
