// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/outliers.hpp"

namespace elastocal {

/// Errors of marker positions, m, by both quantities that the literature calls "RMSE".
struct ErrorMetrics {
  double rmse_3d = 0.0;          ///< RMS distance between measured and predicted positions
  double rmse_coordinate = 0.0;  ///< RMS difference of a coordinate: rmse_3d / sqrt(3)
  double maximum = 0.0;          ///< largest distance; as the others NaN without observations
  int observations = 0;
  Eigen::VectorXd marker_rmse_3d;  ///< by marker; NaN for a marker without observation
};

/// Metrics of `distances` (postures x markers, as ResidualNorms gives them, m) over the
/// observations in `mask` whose distance is finite. NaN if there are none.
ErrorMetrics ComputeMetrics(const Eigen::MatrixXd& distances, const ObservationMask& mask);

/// A 95 % interval of an RMSE, m.
struct RmseInterval {
  double low = 0.0, high = 0.0;
};

/// 95 % interval of the 3-D RMSE over many postures like these, from the scatter of the squares
/// between units (Student's t on a logarithmic scale). `distances` as in ComputeMetrics, NaN where
/// not observed. `unit_of` is the unit of each posture; postures of one unit are much alike.
/// Nothing for fewer than five units.
std::optional<RmseInterval> IntervalOfRmse(const Eigen::MatrixXd& distances,
                                           const std::vector<int>& unit_of);

}  // namespace elastocal
