// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// What may be wrong with a recording as a whole, beyond single markers.
enum class FaultKind {
  kJointGain,    ///< a joint's positions are a multiple of the true ones
  kJointOffset,  ///< a joint's positions are off by a constant from a posture on
  kJointDrift,   ///< they drift steadily from the first to the last posture (of a trial)
  kUnfinished,   ///< positions are ahead by a share of the move from the posture before
  kJointLag,     ///< of motions: they are those of some time before
  kCameraScale,  ///< the cameras' positions in one trial are a multiple of the true ones
  kCameraAxis,   ///< the cameras' coordinates along one of their axes are, in all postures
  kCameraShear,  ///< ... are off by a multiple of those along another axis
  kCameraBend,   ///< the cameras' scale changes with the square of the distance from the middle
};

/// A fault that explains much of what the fit leaves.
struct RecordingFault {
  FaultKind kind = FaultKind::kJointGain;
  int coordinate = -1;  ///< of the joints that are logged together, of the robot tree
  int trial = -1;       ///< the only one that it is in; -1: all
  int posture = 0;      ///< the first one that it is in
  /// Gain less 1; offset, or drift in all, rad or m; s; scale less 1; share of the move; shear;
  /// scale at the outermost marker less that in the middle.
  double size = 0.0;
  double sd = 0.0;     ///< of `size`, as wide as the postures scatter
  double share = 0.0;  ///< of the sum of squared residuals that it explains
  int linkage = -1;    ///< of the tree: `coordinate` is a motor of it; -1: of q
  int end = 0;       ///< of a table, or a drift: the one after the last that it is in; 0: it lasts
  int axis = -1;     ///< of the cameras' frame: 0, 1 or 2
  int by_axis = -1;  ///< of a shear: the one whose coordinate displaces those along `axis`
};

/// How much of its size (of a gain, times the position) a fault has in a posture.
double FactorOf(const RecordingFault& fault, const Recording& recording, int posture);

/// Sizes from which a fault is none that a good robot and good cameras may have. `slides`: of a
/// joint that does.
double LeastSize(FaultKind kind, bool slides);

/// Sizes beyond which a fault is none: where a joint moves no marker, rounding would explain
/// anything with a size large enough.
double LargestSize(FaultKind kind, bool slides);

/// Whether it is more than chance: six standard deviations by the noise that is left without it,
/// and four by that of the fit, which it is a part of. What a robot with play or hysteresis shows
/// as well (lags, unfinished moves): six by that of the fit.
bool IsCertain(const RecordingFault& fault);

/// From the held posture before in the same trial or table, of all joints: postures x coordinates;
/// in motions 0.
Eigen::MatrixXd MovesOf(const Recording& recording);

/// Trials that move a joint by 0.2 rad or m and more.
std::vector<int> AllTrialsThatMove(const Recording& recording, int coordinate);

/// The same; none if there is only one: a gain of its positions there is one in all.
std::vector<int> TrialsThatMove(const Recording& recording, int coordinate);

/// Whether it is in the space that the cameras measure, the same in all postures.
bool IsInCameraSpace(const RecordingFault& fault);

/// By how much a fault of the cameras displaces the markers for each unit of its size, m: as
/// Recording::markers.
Eigen::MatrixXd CameraDisplacements(const RecordingFault& fault, const Recording& recording);

/// The recording without it. Not for motors of rods.
Recording WithoutFault(const Recording& recording, const RecordingFault& fault);

/// Whether the fault is from a posture to the end of its trial: an encoder that was homed anew
/// after the trial.
bool IsInPartOfTrial(const RecordingFault& fault, const Recording& recording);

/// "arm_left_4_joint: its positions are off by 1.02 +- 0.03 deg from trial b, posture 1 on".
std::string DescribeFault(const RecordingFault& fault, const RobotTree& tree,
                          const Recording& recording);

}  // namespace elastocal
