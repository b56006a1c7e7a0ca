// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A posture table with one mistake corrected.
struct LogAlternative {
  std::string what;  ///< the mistake as text
  std::string name;  ///< name for `--accept`; empty: there is none
  Recording recording;
};

/// For each of `joints` that moved: the table with its positions taken from the row before or
/// after, and minus or plus those of its neighbour. Also the table with mirrored markers.
std::vector<LogAlternative> OtherColumns(const Recording& recording, const RobotTree& tree,
                                         const std::vector<int>& joints);

inline constexpr const char* kLeftHanded =
    "the markers are in a left-handed frame (one axis has the wrong sign)";

/// The recording with mirrored markers: one axis is reversed, a level one where gravity is along an
/// axis.
Recording Mirrored(Recording recording);

/// Whether the nominal robot is further than `far` from the markers and much nearer to the mirrored
/// ones. Its root link is placed by the markers (in trials in which it moves: in each posture).
bool LooksMirrored(const ErrorModel& nominal, const Recording& recording, double far);

/// The pair of mistakes of the log with the smallest `misfit`, among all pairs
/// (PossibleLogMistakes; with many joints only signs). Neither mistake need show by itself, and a
/// rotation of three columns is two exchanges. Empty where there is no pair, or too many.
std::vector<LogAlternative> BestPair(const Recording& recording, const RobotTree& tree,
                                     const std::function<double(const Recording&)>& misfit);

}  // namespace elastocal
