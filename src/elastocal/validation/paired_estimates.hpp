// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// Differences B - A between two independent estimates of one robot.
struct PairedEstimates {
  Differences differences;
  std::vector<int> robot;          ///< rows of the robot's parameters, in the order of `common`
  std::vector<LinkMarkers> links;  ///< links with three markers or more in both
  std::vector<std::vector<int>> markers;  ///< by link: rows of its markers' coordinates
};

/// Pairs two estimates. `common` holds the robot's parameters to be paired. The covariance of
/// markers also contains the repeatability of a marker that nobody touched (kMarkerReturns).
/// Without covariance, only variances are used. Throws InputError if a covariance lacks a
/// parameter.
PairedEstimates PairEstimates(const CalibrationEstimate& a, const CalibrationEstimate& b,
                              const std::vector<CommonParameter>& common, bool with_covariance,
                              bool with_markers);

}  // namespace elastocal
