// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/shared_markers.hpp"

namespace elastocal {

/// The markers of a model, where its project has them.
std::vector<MarkerPlace> PlacesOfMarkers(const ErrorModel& model);

/// Decides on which links a recording finds all markers where an earlier calibration has them
/// (FindUnmovedMarkers).
///
/// `estimate` was fitted to the recording with `fitted_with`, which knows the robot by that
/// calibration and so is not independent of it. Its places are therefore compared with those of the
/// estimate that the data alone give of a robot that was never calibrated. Empty if `earlier` has
/// no covariance, or if no link has three markers in both. Throws InputError if its covariance is
/// not positive definite.
std::vector<LinkMarkers> FindMarkersThatStayed(const CalibrationEstimate& earlier,
                                               const CalibrationResult& estimate,
                                               const EarlierEstimate& fitted_with, double level);

}  // namespace elastocal
