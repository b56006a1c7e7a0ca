// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/planning/observed_stance.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

struct ApproachOptions {
  double height = kApproachHeight;  ///< from which a plate goes straight down to its table, m
  double duration_s = 3;            ///< of the way down
};

/// The sets of a posture file of such a project: postures are held as they are, and those of a
/// plate that has a table are approached from above, the plate in its attitude. Throws what FeetOf
/// throws.
std::vector<PostureTour> TouchTours(const Project& project, const StandingRobot& robot,
                                    const std::vector<ChainPostures>& chains,
                                    const ApproachOptions& options, double rate_hz);

}  // namespace elastocal
