// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Pose of the waist in the reference frame that brings the nominal marker positions closest to the
/// measured ones (least squares over all postures, closed form). It is the starting point for T0,
/// and as exact as the nominal marker positions are.
Transform RegisterWaist(const ErrorModel& model, const Recording& recording);

/// As RegisterWaist, but for each posture by itself (one entry each). Nothing where fewer than
/// three markers were seen.
std::vector<std::optional<Transform>> RegisterWaistByPosture(const ErrorModel& model,
                                                             const Recording& recording);

}  // namespace elastocal
