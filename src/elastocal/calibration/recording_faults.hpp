// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// What may be wrong with a recording as a whole, beyond single markers.
enum class FaultKind {
  kJointGain,    ///< a joint's positions are a multiple of the true ones
  kJointOffset,  ///< a joint's positions are off by a constant from a posture on
  kCameraScale,  ///< the cameras' positions in one trial are a multiple of the true ones
};

/// A fault that explains much of what the fit leaves.
struct RecordingFault {
  FaultKind kind = FaultKind::kJointGain;
  int coordinate = -1;  ///< of the joints that are logged together, of the robot tree
  int trial = -1;       ///< the only one that it is in; -1: all
  int posture = 0;      ///< the first one that it is in
  double size = 0.0;    ///< gain less 1; offset, rad or m; scale less 1
  double sd = 0.0;      ///< of `size`, as wide as the postures scatter
  double share = 0.0;   ///< of the sum of squared residuals that it explains
  int linkage = -1;     ///< of the tree: `coordinate` is a motor of it; -1: of q
};

/// Looks for the fault that explains most of what a fit has left: each candidate is one more
/// unknown beside all others (score test), so that it is not confused with what the robot's own
/// errors explain as well. Candidates are the gain of each joint (but of those that rods
/// move, whose levers are the robot's own errors), an offset of each joint, or motor of rods, from
/// a posture on (twelve of them, then all near the best one), in one trial alone or from a posture
/// to the end of its trial (six of each, then all near the best one), and the scale of the cameras
/// in one of several trials (a scale of all of them looks like a robot all of whose lengths are
/// off). Only faults that no good robot has are returned, the one that explains most first: of a
/// size that matters (gain 0.5 %; offset 0.25 degrees, 1 mm; scale 0.15 %), certain (six standard
/// deviations) and a part of what is left (6 %, of a clean ergoCub 4 %; or half of what is left of
/// the chains that it is in).
std::vector<RecordingFault> FindRecordingFaults(const CalibrationResult& result,
                                                const Recording& recording,
                                                const CalibrationOptions& options);

/// Whether the fault is from a posture to the end of its trial: an encoder that was homed anew
/// after the trial.
bool IsInPartOfTrial(const RecordingFault& fault, const Recording& recording);

/// "arm_left_4_joint: its positions are off by 1.02 +- 0.03 deg from trial b, posture 1 on".
std::string DescribeFault(const RecordingFault& fault, const RobotTree& tree,
                          const Recording& recording);

}  // namespace elastocal
