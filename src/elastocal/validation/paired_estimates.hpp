// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/shared_markers.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {

/// What differs between two independent estimates of one robot, B less A.
struct PairedEstimates {
  Differences differences;
  std::vector<int> robot;                 ///< rows of the robot's parameters, in their order
  std::vector<LinkMarkers> links;         ///< of which both have three markers or more
  std::vector<std::vector<int>> markers;  ///< by link, rows of its markers' coordinates
};

/// `common`: the robot's parameters to be paired. The covariance of markers has besides by how
/// little one that nobody touched is found again (kMarkerReturns). Without covariance, variances
/// alone are taken. Throws InputError if a covariance lacks a parameter.
PairedEstimates PairEstimates(const CalibrationEstimate& a, const CalibrationEstimate& b,
                              const std::vector<CommonParameter>& common, bool with_covariance,
                              bool with_markers);

}  // namespace elastocal
