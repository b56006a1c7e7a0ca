// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {

/// A correction of a recording with its own size, for `--accept` (JOINT may be a motor of rods):
///
///     gain:JOINT=1.05          the joint's positions are 1.05 times the true ones, in all trials
///     gain:JOINT@TRIAL=1.05    in this trial alone
///     offset:JOINT@TRIAL=2.1   they are 2.1 deg (of a sliding joint: mm) too large in this trial
///     offset:JOINT@TRIAL:4=2.1 the same from its fourth posture on
///     offset:JOINT:31=2.1      of a table, from its posture 31 on
///     scale:TRIAL=1.005        the cameras' positions are 1.005 times the true ones in this trial
///     scale=1.005              ... in all trials
struct StatedCorrection {
  FaultKind kind = FaultKind::kJointGain;
  int coordinate = -1;  ///< coordinate in the robot tree; -1 for a scale
  /// Linkage of the tree of which `coordinate` is a motor; -1: it is an entry of q.
  int linkage = -1;
  std::string joint = {};  ///< empty for a scale
  std::string trial = {};  ///< empty: all
  int from = 1;            ///< the first posture of the trial with the fault, from 1
  double size = 1.0;       ///< gain or scale; offset in rad or m
};

/// Reads such a name; nothing where it begins with another word. Throws InputError where joint or
/// size are missing, unknown, or larger than any fault (gain and scale from 0.5 to 2; offset 60
/// deg, 200 mm).
std::optional<StatedCorrection> ParseStatedCorrection(const std::string& name,
                                                      const RobotTree& tree);

/// The names that correct a fault, joined by spaces. An offset from a posture on needs one for each
/// trial of this recording from there on; only the user knows on which side a trial for validation
/// is. Nothing where no name corrects the fault.
std::optional<std::string> NameOfCorrection(const RecordingFault& fault, const RobotTree& tree,
                                            const Recording& recording);

/// Makes the correction in the trials for calibration and for validation, and returns its
/// description. Throws InputError for a trial that is in neither.
std::string ApplyCorrection(const StatedCorrection& correction, const RobotTree& tree,
                            Measurements& measured);

/// Throws InputError for a name without a size that corrects nothing. The message lists what can be
/// accepted, or what the recording shows (`shown`).
[[noreturn]] void RefuseAccepted(const std::string& name, const std::set<std::string>& shown);

/// An objection for each joint for which an offset or gain is accepted in all trials for validation
/// that show it (it moves, and a marker that it carries is seen), and in none of those of the
/// estimate that show it. The log then had different states in the two, and no trial shows that the
/// robot is now in the state of the estimate. The same for a scale of the cameras, unless reference
/// lengths tell it in all trials for validation. `names` are those of `--accept`; names without a
/// size are ignored.
std::vector<std::string> UnconfirmedCorrections(const std::vector<std::string>& names,
                                                const Project& project,
                                                const Measurements& measured);

}  // namespace elastocal
