// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Looks for the fault that explains most of what a fit has left: each candidate is one more
/// unknown beside all others (score test), so that it is not confused with what the robot's own
/// errors explain as well. Candidates are the gain of each joint (but of those that rods
/// move, whose levers are the robot's own errors), also in one of several trials that move it, an
/// offset of each joint, or motor of rods, from
/// a posture on (twelve of them, then all near the best one), in one trial alone or from a posture
/// to the end of its trial (six of each, then all near the best one), of a table from a posture to
/// another one and as a steady drift, in motions a lag, the scale of the cameras along one of their
/// axes, a shear of two, a scale that changes from the middle outwards, and that in one of several
/// trials (a scale of all of them looks like a robot all of whose lengths are off). Only faults
/// that no good robot has are returned, the one that explains most first: of a size that matters
/// (gain 0.5 %, of a sliding joint 0.2 %; offset 0.25 degrees, 1 mm; scale 0.15 %), certain (six
/// standard deviations by the noise without it, four by that of the fit; six of what play looks
/// like) and a part of what is left (6 %, of a clean ergoCub 4 %; or half of what is left of the
/// chains that it is in).
std::vector<RecordingFault> FindRecordingFaults(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options);

/// The same fault by what the fit of another recording leaves: its size and standard deviation,
/// whatever they are.
RecordingFault MeasureFault(const RecordingFault& fault, const CalibrationResult& result,
                            const Recording& recording, const CalibrationOptions& options);

}  // namespace elastocal
