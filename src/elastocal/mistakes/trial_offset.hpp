// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Which trials FindTrialOffset examines: those in which one joint explains half of the squares, or
/// all.
enum class OffsetTrials { kFarOff, kAny };

/// Finds a joint with a constant offset in one trial, where noise hides it from
/// FindRecordingFaults: if a leg that stands in the trial has a larger offset than its deflection,
/// the constraint between waist and foot counts less. Each joint is moved in each trial to where
/// the markers are nearest to the predictions of `result`. If that is at least 0.25 degrees or 1 mm
/// and removes half of all squared distances, the offsets of all joints in that trial are estimated
/// beside the errors of the robot. The four that explain most are corrected one by one, and the
/// robot is fitted again.
///
/// An offset is returned only if correcting it leaves less than half of the error, and if held-out
/// trials, which do not have it, are not predicted worse: an offset that explains only the
/// estimate's trials is due to something else that the model lacks. `held_out` may be empty. kAny
/// is for trials that contradict each other, where a fit has distributed the offset over all of
/// them: the offsets of all joints in every trial are estimated.
std::optional<RecordingFault> FindTrialOffset(const CalibrationResult& result,
                                              const BaseParameters& base,
                                              const Recording& recording,
                                              const CalibrationOptions& options,
                                              const Recording& held_out = {},
                                              OffsetTrials in = OffsetTrials::kFarOff);

/// rms distance of the markers of held-out trials, waist and markers being fitted to them, m; none
/// where there are too few for that. Moments of motions are thinned.
std::optional<double> ErrorOnHeldOut(const CalibrationResult& result, const BaseParameters& base,
                                     const Recording& held_out, const CalibrationOptions& options);

}  // namespace elastocal
