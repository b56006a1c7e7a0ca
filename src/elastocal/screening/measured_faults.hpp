// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {

/// MeasureFault of each of several faults, in their order: what the fit leaves is linearised once
/// for all, and once more for each joint whose faults follow each other.
std::vector<RecordingFault> MeasureFaults(const std::vector<RecordingFault>& faults,
                                          const CalibrationResult& result,
                                          const Recording& recording,
                                          const CalibrationOptions& options);

}  // namespace elastocal
