// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/foot_rests.hpp"

namespace elastocal {

/// Sets the share of the weight (FootRest::share) of each of `rests`. `trials` maps FootRest::trial
/// to the trial's index in the recording; -1, or an index beyond the end: the recording does not
/// have it, and the rest stays as it is. Positions and torques of the recording are used as they
/// are. Call this again after mistakes in the recording are undone or torque sensors that
/// contradict statics are removed.
void ShareWeights(const RobotTree& tree, const std::vector<Marker>& markers,
                  const Recording& recording, const std::vector<int>& trials,
                  std::vector<FootRest>& rests);

}  // namespace elastocal
