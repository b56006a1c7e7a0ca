// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Describes a joint that was not recorded and has one position in the project, although the
/// markers show that it moves; empty if there is none.
///
/// Each such joint is moved in each posture to where the markers are nearest, and the robot is
/// fitted again. The joint that leaves the smallest error is named, if that is less than half of
/// the error of `result` (rms distance of the markers), and if the joint is at least 1 degree (2
/// mm) from its usual position in some posture. `recording` is that of `result`.
std::string FindUnrecordedMotion(const Project& project, const RecordedModel& robot,
                                 const Recording& recording, const CalibrationResult& result);

}  // namespace elastocal
