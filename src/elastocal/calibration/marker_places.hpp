// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Where a marker is on its link, as it was measured there.
struct MarkerMeasurement {
  std::string marker;
  Eigen::Vector3d p_link_marker = Eigen::Vector3d::Zero();  ///< in the frame of its link, m
  double sd = 0.0;                                          ///< of each coordinate, m
};

/// Adds the measured places of markers that the model has to what is known beforehand: a normal
/// distribution about each, besides what an earlier calibration says of the same markers.
void KnowMarkers(const std::vector<MarkerMeasurement>& places, const ErrorModel& model,
                 EarlierEstimate& known);

/// How far an estimate that was made with a measured place has the marker from it.
struct PlaceResidual {
  std::string marker;
  double distance = 0.0;  ///< m
  /// Chi-squared of the three numbers: what is left has the variance of the measurement less that
  /// of the estimate there, of which the place is a part.
  double squares = 0.0;
  double in_sds() const;  ///< root mean square of the three, in standard deviations; 1 is expected
};

/// Of the markers whose places were fitted.
std::vector<PlaceResidual> PlaceResiduals(const std::vector<MarkerMeasurement>& places,
                                          const CalibrationResult& result);

/// A place that contradicts where the data and the other places have the marker.
struct ContradictoryPlace {
  std::string marker;
  double distance = 0.0;  ///< m
};

/// How measured places agree with an estimate that was made with them.
struct PlaceAgreement {
  /// By how much their standard deviations are too small: 1, or what makes the median of what is
  /// left the expected one.
  double factor = 1.0;
  /// Those that are further off than chance allows, with standard deviations that much larger, the
  /// furthest first.
  std::vector<ContradictoryPlace> contradictory;
};

/// By the residuals of the places; a chance of `probability` that a right place is named.
PlaceAgreement JudgeMarkers(const std::vector<MarkerMeasurement>& places,
                            const CalibrationResult& result, double probability);

/// Whether what is known beforehand is about the robot, and not about places of markers alone.
bool KnowsRobot(const EarlierEstimate& known);

}  // namespace elastocal
