// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// A joint that was not recorded, that the project has at one position in all postures, and that
/// the markers show to move, in words; empty without one.
///
/// Each such joint is moved in each posture to where it brings the markers nearest, and the robot
/// is fitted again. It is the joint that leaves least, if that is less than half of the error of
/// `result` (rms distance of the markers), and if it is 1 degree (2 mm) and more from its usual
/// position in some posture. `recording`: that of `result`.
std::string FindUnrecordedMotion(const Project& project, const RecordedModel& robot,
                                 const Recording& recording, const CalibrationResult& result);

}  // namespace elastocal
