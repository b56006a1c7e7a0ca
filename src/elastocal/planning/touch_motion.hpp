// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/planning/observed_stance.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

struct ApproachOptions {
  /// Height from which a plate is moved straight down to its table, m.
  double height = kApproachHeight;
  double duration_s = 3;  ///< duration of the way down
};

/// The sets of a posture file for such a project. Postures are held exactly. Those of a plate that
/// has a table are approached from above, with the plate in its final attitude. Throws as FeetOf.
std::vector<PostureTour> TouchTours(const Project& project, const StandingRobot& robot,
                                    const std::vector<ChainPostures>& chains,
                                    const ApproachOptions& options, double rate_hz);

}  // namespace elastocal
