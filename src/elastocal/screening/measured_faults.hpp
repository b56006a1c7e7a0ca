// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {

/// Faults, measured by the residuals of a fit to another recording: sizes and standard deviations,
/// without any limits. What the fit leaves is linearised once for all, and once more for each joint
/// whose faults follow each other.
std::vector<RecordingFault> MeasureFaults(const std::vector<RecordingFault>& faults,
                                          const CalibrationResult& result,
                                          const Recording& recording,
                                          const CalibrationOptions& options);

/// The same of one fault.
inline RecordingFault MeasureFault(const RecordingFault& fault, const CalibrationResult& result,
                                   const Recording& recording, const CalibrationOptions& options) {
  return MeasureFaults({fault}, result, recording, options).front();
}

}  // namespace elastocal
