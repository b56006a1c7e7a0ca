// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/screening/knocks.hpp"

namespace elastocal {

/// Markers of a posture table that fell off and were glued on again elsewhere, at most one in each
/// cluster: from some posture on, its distances to the others of its cluster are other ones, two of
/// them at least, while those among the others stay. By 1 mm and more, and by three times what the
/// distances scatter besides (by medians, so that outliers are none). Empty for trials, whose
/// frames tell it better (session_shapes.hpp).
std::vector<Knock> FindMovedMarkers(const Recording& recording,
                                    const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
