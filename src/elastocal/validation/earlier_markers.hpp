// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/shared_markers.hpp"

namespace elastocal {

/// The markers of a model with their nominal positions.
std::vector<MarkerPlace> PlacesOfMarkers(const ErrorModel& model);

/// Finds the links on which all markers are where an earlier calibration has them
/// (FindUnmovedMarkers).
///
/// `estimate` was fitted to the recording with the earlier estimate `fitted_with` as prior, and so
/// is not independent of it. The comparison therefore uses the marker positions of the estimate
/// that the data and the prior of a new robot give. Empty if `earlier` has no covariance, or if no
/// link has three markers in both. Throws InputError if the covariance is not positive definite.
std::vector<LinkMarkers> FindMarkersThatStayed(const CalibrationEstimate& earlier,
                                               const CalibrationResult& estimate,
                                               const EarlierEstimate& fitted_with, double level);

}  // namespace elastocal
