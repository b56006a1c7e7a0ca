// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/screening/knocks.hpp"

namespace elastocal {

/// Finds markers of a posture table that fell off and were fixed elsewhere, at most one in each
/// cluster. From some posture on, at least two of its distances to the other markers of its cluster
/// are different, while the distances among the others stay. The change is at least 1 mm and three
/// times the scatter of the distances (by medians, so that outliers do not count). Empty for
/// trials, whose frames show it better (session_shapes.hpp).
std::vector<Knock> FindMovedMarkers(const Recording& recording,
                                    const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
