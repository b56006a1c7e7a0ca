// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Changes the positions of a linkage's motors in a posture q (rad; actuators m) and moves its
/// joints to where the nominal rods then have them. False, and q as it was, where the rods reach
/// neither.
bool MoveMotors(const RobotTree& tree, const Linkage& linkage,
                const std::function<void(Eigen::VectorXd& motors)>& change, Eigen::VectorXd& q);

/// What a log has positions of: an entry of q or, with a linkage (else -1), a motor of it.
struct LoggedPosition {
  std::string name;     ///< of the joint or motor
  bool slides = false;  ///< in m, not in rad
};
LoggedPosition LoggedPositionOf(const RobotTree& tree, int linkage, int entry);

/// A motor of the tree's linkages by its name: index of the linkage, and of the rod. (-1, -1):
/// none.
struct MotorIndex {
  int linkage = -1, rod = -1;
};
MotorIndex FindMotor(const RobotTree& tree, const std::string& name);

}  // namespace elastocal
