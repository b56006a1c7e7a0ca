#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/simulation/motions.hpp"

namespace elastocal {

/// How a motion that a user gives becomes trials.
struct GivenMotionOptions {
  std::string name = "motion";  ///< of the trial; of several with their number behind it
  /// Without one: for estimation where the robot comes to rest, else a sinusoidal motion.
  std::optional<TrialKind> kind = {};
  /// What the trials exercise, of the chains; without any, those from the root link on which a
  /// trial does not stand and of which a joint moves in it.
  std::vector<int> chains = {};
};

/// Trials that play a user's own trajectory or postures: one for each stretch of samples with the
/// same support (all feet where nothing is said of it). Each begins with MotionOptions::lead_in_s
/// at rest and ends at rest; postures are MotionOptions::move_s + rest_s apart. Joints of which
/// nothing is said stay as the robot stands when its own trials begin.
///
/// Stretches in which nothing moves but what stands (the weight is shifted) are passed over.
///
/// Throws InputError, naming the line, where the feet on the floor move against each other, where
/// nothing is left to play, and for a stretch of one sample of a trajectory.
std::vector<PlannedTrial> PlanGivenMotion(const RobotTree& tree,
                                          const std::vector<NamedChain>& chains,
                                          const JointMotion& motion, const MotionOptions& options,
                                          const GivenMotionOptions& given);

}  // namespace elastocal
