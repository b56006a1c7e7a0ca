// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/marked_robot.hpp"

namespace elastocal {

std::vector<int> LoggedCoordinates(const RobotTree& tree, const JointLog& log) {
  std::vector<int> coordinates;
  for (const std::string& name : log.names) {
    coordinates.push_back(tree.joints[FindJoint(tree, name)].coordinate);
  }
  return coordinates;
}

}  // namespace elastocal
