// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/label_check.hpp"

namespace elastocal {

/// Two markers whose labels seem exchanged in some trials or in parts of them, whatever the
/// distances in their clusters: each is where the nominal robot has the other, beside the other
/// markers of its cluster (by 10 mm, of two clusters by 50 mm). Both must be seen, and three
/// markers of other clusters, which place the root link. None where all postures that see the two
/// show the same: that does no harm, because the markers' positions are estimated.
std::vector<LabelSuspicion> FindExchangedMarkers(const ErrorModel& model,
                                                 const Recording& recording,
                                                 const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
