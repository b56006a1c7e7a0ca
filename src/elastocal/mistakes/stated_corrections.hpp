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

/// A correction of a recording that says its own size, for `--accept` (JOINT: or a motor of rods):
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
  int coordinate = -1;     ///< of the robot tree; of a scale: -1
  int linkage = -1;        ///< of the tree: `coordinate` is a motor of it; -1: of q
  std::string joint = {};  ///< of a scale: empty
  std::string trial = {};  ///< empty: all
  int from = 1;            ///< the first posture of the trial that has it, from 1
  double size = 1.0;       ///< gain or scale; offset in rad or m
};

/// Reads such a name; nothing where it begins with another word. Throws InputError where joint or
/// size are missing, unknown, or beyond what can be a fault (gain and scale from 0.5 to 2; offset
/// 60 deg, 200 mm).
std::optional<StatedCorrection> ParseStatedCorrection(const std::string& name,
                                                      const RobotTree& tree);

/// The names that correct a fault, joined by spaces. An offset from a posture on has one for each
/// trial of this recording from there on; on which side a trial for validation stands, only its
/// user knows. Nothing where no name does it.
std::optional<std::string> NameOfCorrection(const RecordingFault& fault, const RobotTree& tree,
                                            const Recording& recording);

/// Undoes it in the trials for calibration and for validation; what was undone, in words. Throws
/// InputError for a trial that is in neither.
std::string ApplyCorrection(const StatedCorrection& correction, const RobotTree& tree,
                            Measurements& measured);

/// Throws the InputError of a name without a size that corrects nothing: what can be accepted, or
/// what the recording does show (`shown`).
[[noreturn]] void RefuseAccepted(const std::string& name, const std::set<std::string>& shown);

/// An objection for each joint of which an offset or gain is accepted in all trials for validation
/// that show it (it moves, and a marker that it carries is seen), and in none of those of the
/// estimate that do: the log had one state in these and another one in those, and no trial shows
/// that the robot is now in that of the estimate. `names` of `--accept`; others than those with a
/// size say nothing here.
std::vector<std::string> UnconfirmedCorrections(const std::vector<std::string>& names,
                                                const Project& project,
                                                const Measurements& measured);

}  // namespace elastocal
