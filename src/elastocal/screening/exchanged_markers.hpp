// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/label_check.hpp"

namespace elastocal {

/// Finds pairs of markers whose labels seem exchanged in some trials or in parts of them, whatever
/// the distances in their clusters. Relative to the other markers of their clusters, each is where
/// the nominal robot has the other (by at least 10 mm; for markers of two clusters 50 mm). Both
/// must be seen, and three markers of other clusters, which place the root link. A pair on one body
/// that looks the same in all postures that show it is not returned: this does no harm, because the
/// markers' positions are estimated.
std::vector<LabelSuspicion> FindExchangedMarkers(const ErrorModel& model,
                                                 const Recording& recording,
                                                 const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
