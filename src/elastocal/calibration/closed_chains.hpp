// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Hides the markers on the feet in postures on several feet (sets them to NaN, not seen). There
/// the legs form a closed chain whose distribution of load and deflection is unknown, and the model
/// of open chains does not describe these markers. Call it after the clocks are synchronised, which
/// needs these markers.
void HideClosedChains(const RobotTree& tree, const std::vector<Marker>& markers,
                      Recording& recording);

}  // namespace elastocal
