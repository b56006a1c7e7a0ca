// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/report/calibration_view.hpp"

namespace elastocal {

/// What the 3-D view plays, one entry a trial (a table of postures: one in all), in a frame with z
/// up: postures, where the robot stood, measured markers, and those predicted by the uncalibrated
/// and by the best model.
nlohmann::ordered_json MakeScenes(const CalibrationView& view);

}  // namespace elastocal
