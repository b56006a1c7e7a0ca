// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/report/calibration_view.hpp"

namespace elastocal {

/// Histograms of the distances between measured and predicted markers, for the calibration postures
/// and for each trial kept for validation by chain, each model over the observations that all of
/// them predict (outliers of the calibration aside).
nlohmann::ordered_json MakeDistributions(const CalibrationView& view);

/// The clusters with their RMSE by model: on trials for validation where there are any (markers
/// that these do not show have none), else on the calibration postures.
nlohmann::ordered_json MakeClusters(const CalibrationView& view);

/// Root mean square over the markers, moment by moment, of each trial for validation, uncalibrated
/// and by the best model.
nlohmann::ordered_json MakeTraces(const CalibrationView& view);

}  // namespace elastocal
