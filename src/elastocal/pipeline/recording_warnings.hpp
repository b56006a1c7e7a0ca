// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/screening/camera_scale.hpp"

namespace elastocal {

/// What is too small or too uncertain for an objection to a recording, in sentences: clusters that
/// are turned or loose, positions that are coarse or scattered, gains, and a scale that no length
/// tells.
std::vector<std::string> RecordingWarnings(const Project& project, const CalibrationResult& fit,
                                           const Recording& recording,
                                           const std::vector<TrialSummary>& trials,
                                           const std::optional<CommonScale>& scale);

}  // namespace elastocal
