// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Joints, of the model's tree, whose axes an estimate turned by more than a right angle, which is
/// no error of a robot: the sign of their positions, or of those of the joint before, is reversed.
std::vector<int> TurnedAxes(const CalibrationResult& result);

}  // namespace elastocal
