// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Kinds of mistakes in the logged positions of a joint.
enum class LogContradiction {
  kSign,      ///< they have the opposite sign
  kExchange,  ///< two joints have each other's positions
  kFrozen,    ///< they stayed the same while the joint moved
};

/// A mistake in the joint log or a posture table that the markers show.
struct LogSuspicion {
  LogContradiction kind = LogContradiction::kSign;
  int coordinate = 0;  ///< coordinate in the robot tree
  int other = -1;      ///< coordinate with which it is exchanged
  /// Linkage of the tree whose motors `coordinate` and `other` are; -1: they are entries of q.
  int linkage = -1;
  std::vector<int> postures = {};  ///< postures with the mistake, ascending
  /// Median absolute difference between PositionsByMarkers and the log there, rad or m; for a
  /// table, distance of the markers from the nominal robot, m.
  double before = 0.0;
  double after = 0.0;  ///< the same with the mistake corrected; for kFrozen: in the other postures
};

/// Finds mistakes in the joint log of a recording of trials that are far larger than errors of a
/// robot: a reversed sign, two joints exchanged, a joint frozen in part of a trial. They are found
/// trial by trial with the nominal robot, before anything is estimated. A suspicion is no proof: a
/// fit has to tell whether the corrected recording fits. The one that explains most comes first.
/// Empty for a posture table (FindTableSuspicions).
std::vector<LogSuspicion> FindLogSuspicions(const ErrorModel& model, const Recording& recording);

/// All mistakes that a posture table can have in all of its postures, for joints that moved: signs,
/// then exchanges, in both those of motors of linkages first. Empty for a recording of trials.
std::vector<LogSuspicion> PossibleLogMistakes(const Recording& recording, const RobotTree& tree);

/// The recording with the mistake corrected: positions and the directions of the last motions
/// (Recording::approach) changed, or the postures left out in which a joint was frozen. Throws
/// InputError where the rods of a linkage would not close.
Recording WithoutMistake(const Recording& recording, const LogSuspicion& suspicion,
                         const RobotTree& tree);

/// Name of the mistake for `--accept`: "sign:arm_left_7_joint".
std::string NameOf(const LogSuspicion& suspicion, const RobotTree& tree);

/// Text such as "arm_left_7_joint: the sign of its positions is reversed in trial a".
std::string DescribeSuspicion(const LogSuspicion& suspicion, const RobotTree& tree,
                              const Recording& recording);

}  // namespace elastocal
