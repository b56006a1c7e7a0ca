// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/move_motors.hpp"

#include <vector>

#include "elastocal/robot/linkage.hpp"

namespace elastocal {

bool MoveMotors(const RobotTree& tree, const Linkage& linkage,
                const std::function<void(Eigen::VectorXd& motors)>& change, Eigen::VectorXd& q) {
  const std::vector<int> entries = CoordinatesOf(tree, linkage);
  auto motors = MotorPositions(tree, linkage, q(entries));
  if (!motors) return false;
  change(*motors);
  const auto joints = JointsFromMotors(tree, linkage, *motors);
  if (!joints) return false;
  q(entries) = *joints;
  return true;
}

LoggedPosition LoggedPositionOf(const RobotTree& tree, int linkage, int entry) {
  const auto at = static_cast<std::size_t>(entry);
  if (linkage >= 0) {
    const Rod& rod = tree.linkages[static_cast<std::size_t>(linkage)].rods[at];
    return {rod.motor, rod.actuator};
  }
  const Joint& joint = tree.joints[static_cast<std::size_t>(tree.coordinate_joint[at])];
  return {joint.name, joint.type == JointType::kPrismatic};
}

MotorIndex FindMotor(const RobotTree& tree, const std::string& name) {
  for (std::size_t k = 0; k < tree.linkages.size(); ++k) {
    for (std::size_t r = 0; r < tree.linkages[k].rods.size(); ++r) {
      if (tree.linkages[k].rods[r].motor == name) {
        return {static_cast<int>(k), static_cast<int>(r)};
      }
    }
  }
  return {};
}

}  // namespace elastocal
