// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/report/calibration_view.hpp"

namespace elastocal {

/// What the 3-D view plays: one entry for each trial (a posture table is one), in a frame with z
/// up. It contains postures, poses of the waist, measured markers, and those predicted by the
/// uncalibrated and by the best model.
nlohmann::ordered_json MakeScenes(const CalibrationView& view);

}  // namespace elastocal
