// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// The trials of FindTrialOffset: those in which one joint takes half of the squares, or all.
enum class OffsetTrials { kFarOff, kAny };

/// A joint that is off by a constant in one trial, where noise hides it from FindRecordingFaults: a
/// leg that stands there is off by more than it gives way, and what ties the waist to its foot
/// counts the less. Each joint is moved in each trial, by what brings the markers nearest to where
/// the robot of `result` puts them. Where that is 0.25 degrees or 1 mm and more, and takes half of
/// all squared distances, the offsets of all joints in that trial are estimated beside the errors
/// of the robot, and the four that explain most are undone, one by one, and the robot fitted again.
/// Nothing unless one leaves half of the error, and none without which held-out trials, which do
/// not have it, are predicted worse: what explains the estimate's trials alone is something else
/// that the model lacks. `held_out` may be empty. kAny: where trials contradict each other, a fit
/// has spread the offset over all of them; the offsets of all joints in every trial are estimated.
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
