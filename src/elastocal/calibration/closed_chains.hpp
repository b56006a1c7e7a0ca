// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Hides the markers of the feet in postures on several feet (NaN: not seen). There the legs close
/// a chain, and how they share the load and give way is not known: what these markers show is not
/// what the model of open chains says of them. They have helped to find the clock.
void HideClosedChains(const RobotTree& tree, const std::vector<Marker>& markers,
                      Recording& recording);

}  // namespace elastocal
