// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Faults of a recording as a whole, beyond single markers.
enum class FaultKind {
  kJointGain,    ///< positions of a joint are a multiple of the true ones
  kJointOffset,  ///< positions of a joint have a constant offset from some posture on
  /// Positions of a joint drift steadily from the first to the last posture (of a trial)
  kJointDrift,
  /// Positions are ahead of the true ones by a share of the move from the posture before.
  kUnfinished,
  kJointLag,     ///< in motions: positions are those of an earlier time
  kCameraScale,  ///< positions by the cameras in one trial are a multiple of the true ones
  kCameraAxis,   ///< coordinates along one of the cameras' axes are a multiple, in all postures
  /// Coordinates along one axis are off by a multiple of those along another, in all postures.
  kCameraShear,
  kCameraBend,  ///< scale of the cameras changes with the square of the distance from the middle
  /// The frame of a table's markers is displaced from some posture on.
  kFrameShift,
};

/// A fault that explains much of the residuals of a fit.
struct RecordingFault {
  FaultKind kind = FaultKind::kJointGain;
  int coordinate = -1;  ///< coordinate in the robot tree (of joints that are logged together)
  int trial = -1;       ///< the only trial with the fault; -1: all
  int posture = 0;      ///< the first posture with the fault
  /// Gain minus 1; offset, or drift over all postures, rad or m; displacement, m; time, s; scale
  /// minus 1; share of the move; shear; scale at the outermost marker minus that in the middle.
  double size = 0.0;
  double sd = 0.0;     ///< standard deviation of `size`, by the scatter of the postures
  double share = 0.0;  ///< share of the sum of squared residuals that it explains
  /// Linkage of the tree of which `coordinate` is a motor; -1: it is an entry of q.
  int linkage = -1;
  /// In a table, or of a drift: the posture after the last one with it; 0: to the end.
  int end = 0;
  int axis = -1;     ///< axis of the cameras' frame: 0, 1 or 2
  int by_axis = -1;  ///< of a shear: axis whose coordinate displaces those along `axis`
  /// Direction of a displacement of the frame, a unit vector in its axes. Of an offset of a sliding
  /// joint: that of a displacement which explains as much (PreferSlides).
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
};

/// Factor of a fault's size in a posture: of a gain, the position.
double FactorOf(const RecordingFault& fault, const Recording& recording, int posture);

/// Smallest size that a good robot with good cameras does not have. `slides`: the joint is
/// prismatic.
double LeastSize(FaultKind kind, bool slides);

/// Largest size of a fault. Where a joint moves no marker, a fault of any larger size would explain
/// rounding.
double LargestSize(FaultKind kind, bool slides);

enum class Certainty {
  kCertain,
  kSuspected,  ///< a fit has to prove it: four standard deviations by the noise of the fit
};

/// Whether a fault exceeds chance: six standard deviations by the noise that is left without it,
/// and four by that of the fit, which contains the fault. Lags and unfinished moves, which a robot
/// with play or hysteresis also shows: six by that of the fit.
bool IsCertain(const RecordingFault& fault, Certainty certainty = Certainty::kCertain);

/// Moves of all joints from the held posture before, in the same trial or table: postures x
/// coordinates; 0 in motions.
Eigen::MatrixXd MovesOf(const Recording& recording);

/// Trials in which a joint moves by more than 0.2 rad or m.
std::vector<int> AllTrialsThatMove(const Recording& recording, int coordinate);

/// As AllTrialsThatMove, but empty if there is only one: a gain in that trial is one in all.
std::vector<int> TrialsThatMove(const Recording& recording, int coordinate);

/// Whether the fault is one of the space that the cameras measure, the same in all postures.
bool IsInCameraSpace(const RecordingFault& fault);

/// Displacements of the markers by a fault of the cameras for one unit of its size, m: as
/// Recording::markers.
Eigen::MatrixXd CameraDisplacements(const RecordingFault& fault, const Recording& recording);

/// The recording with a fault added of size `step`, without its factors of the postures; of a motor
/// of rods, joints follow it.
Recording WithStep(const RecordingFault& fault, const RobotTree& tree, double step,
                   const Recording& recording);

/// The recording with the fault corrected. Not for motors of rods.
Recording WithoutFault(const Recording& recording, const RecordingFault& fault);

/// Whether the fault extends from a posture to the end of its trial, as if an encoder was homed
/// anew after the trial.
bool IsInPartOfTrial(const RecordingFault& fault, const Recording& recording);

/// Text such as "arm_left_4_joint: its positions are off by 1.02 +- 0.03 deg from trial b, posture
/// 1 on".
std::string DescribeFault(const RecordingFault& fault, const RobotTree& tree,
                          const Recording& recording);

}  // namespace elastocal
