// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What is wrong with the positions that were logged for a joint.
enum class LogContradiction {
  kSign,      ///< they have the opposite sign
  kExchange,  ///< two joints have each other's
  kFrozen,    ///< they stayed the same while the joint moved
};

/// A mistake in the joint log or a table, as the markers show it.
struct LogSuspicion {
  LogContradiction kind = LogContradiction::kSign;
  int coordinate = 0;  ///< of the robot tree
  int other = -1;      ///< the one that it is exchanged with
  int linkage = -1;    ///< of the tree: `coordinate` and `other` are motors of it; -1: of q
  std::vector<int> postures = {};  ///< ascending, in which the log is wrong
  /// PositionsByMarkers less the log there, median of the absolute, rad or m; of a table, how far
  /// markers are from the nominal robot, m.
  double before = 0.0;
  double after = 0.0;  ///< the same once the mistake is undone; of kFrozen, elsewhere
};

/// Mistakes in the joint log of a recording of trials that are far larger than errors of a robot:
/// the sign of a joint, two joints exchanged, a joint frozen in part of a trial. Each is told trial
/// by trial, by the nominal robot, before anything is estimated. A suspicion is no proof: whether
/// the recording fits once it is undone, a fit has to say. The one that explains most first; empty
/// for a table of postures (FindTableSuspicions).
std::vector<LogSuspicion> FindLogSuspicions(const ErrorModel& model, const Recording& recording);

/// Every mistake that the log of a posture table may have in all postures, of joints that moved:
/// signs, then exchanges, each of motors of linkages first. None for a recording of trials.
std::vector<LogSuspicion> PossibleLogMistakes(const Recording& recording, const RobotTree& tree);

/// The recording without that mistake: positions corrected, or the postures left out in which a
/// joint was frozen. Throws InputError where the rods of a linkage would not close.
Recording WithoutMistake(const Recording& recording, const LogSuspicion& suspicion,
                         const RobotTree& tree);

/// What `--accept` calls it: "sign:arm_left_7_joint".
std::string NameOf(const LogSuspicion& suspicion, const RobotTree& tree);

/// "arm_left_7_joint: the sign of its positions is reversed in trial a"
std::string DescribeSuspicion(const LogSuspicion& suspicion, const RobotTree& tree,
                              const Recording& recording);

}  // namespace elastocal
