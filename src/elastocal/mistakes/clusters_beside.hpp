// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// The clusters, of those given, that no other of them separates from a joint which one of the
/// coordinates moves. If such a joint seems to be elsewhere, a cluster further away is not what is:
/// the nearer ones would not seem displaced. Markers are those of the model.
std::vector<LabelCluster> ClustersBeside(const std::vector<int>& coordinates,
                                         const std::vector<LabelCluster>& clusters,
                                         const ErrorModel& model);

}  // namespace elastocal
