// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/moving_coordinates.hpp"

#include <set>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

std::vector<int> MovingCoordinates(const ErrorModel& model) {
  std::set<int> coordinates;
  for (const int joint : model.active_joints) {
    for (const Drive& drive : DrivesOf(model.tree.joints[Size(joint)])) {
      coordinates.insert(drive.coordinate);
    }
  }
  return {coordinates.begin(), coordinates.end()};
}

}  // namespace elastocal
