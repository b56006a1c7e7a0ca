// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A posture table, once a mistake is undone.
struct LogAlternative {
  std::string what;  ///< the mistake, in words
  std::string name;  ///< what `--accept` calls it; empty: nothing
  Recording recording;
};

/// The table with the positions of one of `joints` taken from the row before or after, for each
/// that moved; less, or plus, those of its neighbour; and with markers of the opposite hand.
std::vector<LogAlternative> OtherColumns(const Recording& recording, const RobotTree& tree,
                                         const std::vector<int>& joints);

inline constexpr const char* kLeftHanded =
    "the markers are in a left-handed frame (one axis has the wrong sign)";

/// With the markers of the opposite hand: one axis reversed, which is level where gravity is along
/// an axis.
Recording Mirrored(Recording recording);

/// Whether the nominal robot, with its root link where the markers have it (of trials in which that
/// moves, in each posture), is far from the markers and much nearer to those of the opposite hand.
bool LooksMirrored(const ErrorModel& nominal, const Recording& recording, double far);

/// The pair of mistakes of the log that leaves the least `misfit`, from all pairs
/// (PossibleLogMistakes; with many joints only signs). Neither need show by itself, and three
/// columns that went round are two exchanges. Empty where there is no pair, or too many.
std::vector<LogAlternative> BestPair(const Recording& recording, const RobotTree& tree,
                                     const std::function<double(const Recording&)>& misfit);

}  // namespace elastocal
