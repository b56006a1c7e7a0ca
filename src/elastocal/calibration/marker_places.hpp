// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Position of a marker on its link that was measured by other means.
struct MarkerMeasurement {
  std::string marker;
  Eigen::Vector3d p_link_marker = Eigen::Vector3d::Zero();  ///< in the frame of its link, m
  double sd = 0.0;  ///< standard deviation of each coordinate, m
};

/// Adds measured places to the prior knowledge `known`: a normal distribution about each
/// coordinate, combined with what an earlier calibration says of the same marker. Markers that the
/// model does not have are ignored.
void KnowMarkers(const std::vector<MarkerMeasurement>& places, const ErrorModel& model,
                 EarlierEstimate& known);

/// Deviation of an estimated marker position from its measured place, in an estimate that used the
/// place.
struct PlaceResidual {
  std::string marker;
  double distance = 0.0;  ///< m
  /// Chi-squared of the three coordinates. The expected variance is that of the measurement less
  /// that of the estimate, because the estimate contains the place.
  double squares = 0.0;
  /// Root mean square of the three coordinates, in standard deviations; 1 is expected.
  double in_sds() const;
};

/// Residuals of the places whose markers were estimated.
std::vector<PlaceResidual> PlaceResiduals(const std::vector<MarkerMeasurement>& places,
                                          const CalibrationResult& result);

/// A place that contradicts the marker's position according to the data and the other places.
struct ContradictoryPlace {
  std::string marker;
  double distance = 0.0;  ///< m
};

/// Agreement of measured places with an estimate that used them.
struct PlaceAgreement {
  /// Factor by which the standard deviations of the places are too small: the one that makes the
  /// median residual the expected one, at least 1.
  double factor = 1.0;
  /// Places that are further off than chance allows, after `factor` is applied; the furthest first.
  std::vector<ContradictoryPlace> contradictory;
};

/// Judges measured places by their residuals. With probability `probability` at least one correct
/// place is named.
PlaceAgreement JudgeMarkers(const std::vector<MarkerMeasurement>& places,
                            const CalibrationResult& result, double probability);

/// Whether the prior knowledge contains parameters of the robot, and not only positions of markers.
bool KnowsRobot(const EarlierEstimate& known);

}  // namespace elastocal
