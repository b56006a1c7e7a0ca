// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Those of the clusters that no other one separates from a joint which one of the coordinates
/// moves. If such a joint appears displaced, the true cause cannot be a cluster further away,
/// because the nearer ones would not appear displaced. Markers are those of the model.
std::vector<LabelCluster> ClustersBeside(const std::vector<int>& coordinates,
                                         const std::vector<LabelCluster>& clusters,
                                         const ErrorModel& model);

}  // namespace elastocal
