// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/parameters.hpp"

namespace elastocal {

/// "a, b, c" of parameter names, with the coordinates of one marker and the constants of one joint
/// together: "arm_left_7_joint.{theta,r}".
std::string JoinNames(const std::vector<Parameter>& parameters, const std::vector<int>& which);

}  // namespace elastocal
