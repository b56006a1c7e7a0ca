// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/report/calibration_view.hpp"

namespace elastocal {

/// Histograms of the distances between measured and predicted markers: for the calibration
/// postures, and for each trial for validation by chain. All models are shown over the same
/// observations: those that all predict, without outliers of the calibration.
nlohmann::ordered_json MakeDistributions(const CalibrationView& view);

/// The clusters with their RMSE by model: on trials for validation if there are any (none for
/// markers that these do not show), else on the calibration postures.
nlohmann::ordered_json MakeClusters(const CalibrationView& view);

/// Root mean square error over the markers at each moment of each trial for validation:
/// uncalibrated, and by the best model.
nlohmann::ordered_json MakeTraces(const CalibrationView& view);

}  // namespace elastocal
