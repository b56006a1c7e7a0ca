// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/zero_offset.hpp"

#include <algorithm>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

bool IsZeroOffset(const Parameter& parameter, const RobotTree& tree) {
  if (parameter.kind == ParameterKind::kMotorZero) return true;
  if (parameter.linkage >= 0) {
    const std::vector<Rod>& rods = tree.linkages[Size(parameter.linkage)].rods;
    return std::any_of(rods.begin(), rods.end(), [&](const Rod& rod) {
      return rod.actuator && parameter.name == rod.motor + ".length";
    });
  }
  if (parameter.joint < 0) return false;
  const bool prismatic = tree.joints[parameter.joint].type == JointType::kPrismatic;
  return parameter.kind == (prismatic ? ParameterKind::kR : ParameterKind::kTheta);
}

}  // namespace elastocal
