// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/robot/parameters.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Whether a parameter is what a displaced encoder changes: theta, or r of a prismatic joint; the
/// zero of a motor with a rod, or the length of a linear actuator.
bool IsZeroOffset(const Parameter& parameter, const RobotTree& tree);

}  // namespace elastocal
