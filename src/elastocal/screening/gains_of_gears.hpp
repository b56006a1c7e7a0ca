// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// The gains of joints' positions that a fit describes as errors of gears and leads: a joint that
/// turns 1 + e times as far as its log says has a log of 1 / (1 + e) times the true positions. `sd`
/// is that of e.
std::vector<RecordingFault> GainsOfGears(const CalibrationResult& result);

}  // namespace elastocal
