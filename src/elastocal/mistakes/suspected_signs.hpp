// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// The suspicion that the sign of a coordinate is reversed in all postures.
LogSuspicion SignOf(int coordinate, const Recording& recording);

/// The reversed signs of all joints that move: where nothing explains a recording, each is
/// suspected. Empty for a robot with many joints, since each takes a fit of seconds.
std::vector<LogSuspicion> AllSigns(const RobotTree& tree, const Recording& recording);

/// The reversed signs suspected in a fit with axes that are turned by more than a right angle: of
/// each such joint and of the one before it, which may be the true one, even where the nominal
/// robot does not show it.
std::vector<LogSuspicion> SignsOfTurnedAxes(const CalibrationResult& result,
                                            const Recording& recording);

}  // namespace elastocal
