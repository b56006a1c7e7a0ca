// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/math/random.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// The motions on which a calibration is validated (paper, section 6.1.4).
enum class ValidationKind {
  kSine,           ///< sinusoidal motions of every joint of a chain, one after the other
  kRandom,         ///< random postures in the workspaces of the calibration postures
  kRepeatability,  ///< one random posture several times, each time from the posture of rest
};

struct ValidationOptions {
  int random_postures = 20;
  int repetitions = 5;
  int tries = 2000;  ///< most draws for one posture; if all fail, the set gets fewer postures
};

/// One set for each chain. Random postures are drawn uniformly within the limits of `setup`, with
/// the tip in the chain's box and cone; postures that cannot be held at rest are drawn anew. Joints
/// of standing legs have no sine. Throws InputError if a support foot of a chain is not a sole.
std::vector<PostureTour> ValidationTours(const StandingRobot& robot, const MotionSetup& setup,
                                         const std::vector<ChainSetup>& chains, ValidationKind kind,
                                         const ValidationOptions& options, Random& random);

/// Indices of the soles of support feet (links). Throws InputError for links that are not soles,
/// and unless they are all of the soles or all but one.
std::vector<int> FeetOf(const StandingRobot& robot, const std::vector<int>& links);

}  // namespace elastocal
