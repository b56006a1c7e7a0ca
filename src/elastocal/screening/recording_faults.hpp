// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Finds the fault that explains most of the residuals of a fit. Each candidate is tested as one
/// more unknown beside all others (score test), so that it is not confused with errors of the robot
/// that explain the same. Candidates are:
///
/// - the gain of each joint, also in one of several trials that move it (not of joints that rods
///   move, whose levers are errors of the robot);
/// - an offset of each joint, or motor of rods: from a posture on (48 postures, then all near the
///   best), in one trial, from a posture to the end of its trial (six of each, then all near
///   the best), and in a table from one posture to another;
/// - in a table, a steady drift of each joint; in motions, a lag;
/// - the scale of the cameras along one of their axes, a shear of two axes, and a scale that
///   changes from the middle outwards;
/// - in a table whose root link is held: a displacement of the markers' frame in any direction,
///   from a posture on, or from one posture to another;
/// - the scale of the cameras in one of several trials (a common scale of all trials looks like a
///   robot with wrong lengths).
///
/// Only faults that no good robot has are returned, the one that explains most first. The size must
/// matter (gain 0.5 %, of a prismatic joint 0.2 %; offset 0.25 degrees or 1 mm; scale 0.15 %). The
/// fault must be certain (IsCertain). It must explain 6 % of the squared residuals (a clean ergoCub
/// reaches 4 %), or half of those of the chains with the fault.
std::vector<RecordingFault> FindRecordingFaults(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options,
                                                Certainty certainty = Certainty::kCertain);

}  // namespace elastocal
