// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Gains of sliding joints are what a wrong scale of the cameras looks like: several that are alike
/// are one, and of one that the other lengths bear out both are said. Nothing for other faults.
std::string ScaleOfSlides(const std::vector<RecordingFault>& faults,
                          const CalibrationResult& result, const CalibrationOptions& options);

/// Joints whose gear or lead seems further off than any is made (FindRecordingFaults: 0.5 %): what
/// was taken for a cause of the robot is a wrong gain in its log.
std::vector<RecordingFault> FindImpossibleGears(const CalibrationResult& result);

}  // namespace elastocal
