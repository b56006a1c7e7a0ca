// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// The joint whose position an entry of the position vector q is.
inline const Joint& JointOfCoordinate(const RobotTree& tree, Eigen::Index coordinate) {
  return tree.joints[Size(tree.coordinate_joint[Size(coordinate)])];
}

}  // namespace elastocal
