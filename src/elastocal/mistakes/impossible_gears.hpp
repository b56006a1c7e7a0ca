// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Gains of prismatic joints look like a wrong scale of the cameras. Several similar ones are
/// described as one scale; where the other lengths agree with a single one, both explanations are
/// given. Empty for other faults, and where one length alone makes the scale.
std::string ScaleOfSlides(const std::vector<RecordingFault>& faults,
                          const CalibrationResult& result, const CalibrationOptions& options);

/// Joints whose estimated gear or lead error is larger than any in a real robot (0.5 %), by at
/// least five standard deviations. Such a cause is a wrong gain in the joint's log.
std::vector<RecordingFault> FindImpossibleGears(const CalibrationResult& result);

}  // namespace elastocal
