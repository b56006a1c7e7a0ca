// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/camera_scale.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Gains of prismatic joints look like a wrong scale of the cameras. Several similar ones are
/// described as one scale; where the other lengths (`scale`, of EstimateCommonScale) agree with a
/// single one, both explanations are given. Empty for other faults, and where one length alone
/// makes the scale.
std::string ScaleOfSlides(const std::vector<RecordingFault>& faults, const RobotTree& tree,
                          const std::optional<CommonScale>& scale);

/// Joints whose estimated gear or lead error is larger than any in a real robot (0.5 %), by at
/// least five standard deviations. Such a cause is a wrong gain in the joint's log.
std::vector<RecordingFault> FindImpossibleGears(const CalibrationResult& result);

}  // namespace elastocal
