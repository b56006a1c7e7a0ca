// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/foot_rests.hpp"

namespace elastocal {

/// Tells the shares of the weight (FootRest::share) of rests. `trials`: by FootRest::trial, the
/// number of the trial in the recording, or -1 where that does not have it: such a rest stays as it
/// is. Positions and torques of the recording are taken as they are: shares are told anew once
/// mistakes are undone, and sensors that contradict statics hidden.
void ShareWeights(const RobotTree& tree, const std::vector<Marker>& markers,
                  const Recording& recording, const std::vector<int>& trials,
                  std::vector<FootRest>& rests);

}  // namespace elastocal
