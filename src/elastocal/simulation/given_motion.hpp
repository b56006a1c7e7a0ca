// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/robot/standing.hpp"
#include "elastocal/simulation/motions.hpp"

namespace elastocal {

/// How a user's own motion is played as trials.
struct GivenMotionOptions {
  std::string name = "motion";  ///< name of the trial; several trials have their number added
  /// By default kCalibration if the robot comes to rest in the trial, and otherwise kSine.
  std::optional<TrialKind> kind = {};
  /// The chains that the trials exercise. By default those from the root link of which a joint
  /// moves in the trial, except the legs on which the robot stands.
  std::vector<int> chains = {};
  std::vector<Sole> soles = {};  ///< balls may turn where they stand; other feet are flat
};

/// Makes trials that play a user's own trajectory or postures: one for each stretch of samples with
/// the same support (by default all feet). Each trial begins with MotionOptions::lead_in_s at rest
/// and ends at rest; postures are MotionOptions::move_s + rest_s apart. Joints that the motion
/// leaves open keep the position that they have at the beginning of the robot's own trials.
///
/// Stretches in which only standing legs move (the weight is shifted) are skipped.
///
/// A trajectory is played without a break: a flat foot that stands from one trial into the next one
/// stays where it is, and is the first foot of `support` in both. If a robot stands on both feet
/// between two trials on one foot, only the foot on which it stood in the trial before stays.
///
/// Throws InputError, naming the line, if feet on the floor move against each other, if nothing is
/// left to play, and for a stretch of a trajectory that has only one sample.
std::vector<PlannedTrial> PlanGivenMotion(const RobotTree& tree,
                                          const std::vector<NamedChain>& chains,
                                          const JointMotion& motion, const MotionOptions& options,
                                          const GivenMotionOptions& given);

}  // namespace elastocal
