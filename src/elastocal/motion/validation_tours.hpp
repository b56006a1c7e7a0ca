#pragma once

#include <vector>

#include "elastocal/math/random.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// The motions on which a calibration is tried (paper, section 6.1.4).
enum class ValidationKind {
  kSine,           ///< every joint of a chain to and fro, one after the other
  kRandom,         ///< random postures in the workspaces of the calibration postures
  kRepeatability,  ///< one random posture, several times from the posture of rest
};

struct ValidationOptions {
  int random_postures = 20;
  int repetitions = 5;
  int tries = 2000;  ///< draws for a posture before fewer are taken
};

/// One set a chain. Random postures are drawn uniformly within the limits of `setup`, with the tip
/// in the chain's box and cone; those that cannot be kept at rest are drawn anew. A joint of a leg
/// that stands has no sine. Throws InputError for a chain that stands on what is no sole.
std::vector<PostureTour> ValidationTours(const StandingRobot& robot, const MotionSetup& setup,
                                         const std::vector<ChainSetup>& chains, ValidationKind kind,
                                         const ValidationOptions& options, Random& random);

/// Feet of a support (links), as indices of soles. Throws InputError for links that are none, and
/// for other than one or all of the soles.
std::vector<int> FeetOf(const StandingRobot& robot, const std::vector<int>& links);

}  // namespace elastocal
