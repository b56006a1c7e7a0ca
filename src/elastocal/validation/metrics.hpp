// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/outliers.hpp"

namespace elastocal {

/// Marker errors, by both of the quantities that the literature calls "RMSE", m.
struct ErrorMetrics {
  double rmse_3d = 0.0;          ///< RMS distance between measured and predicted positions
  double rmse_coordinate = 0.0;  ///< RMS difference of a coordinate: rmse_3d / sqrt(3)
  double maximum = 0.0;          ///< largest distance
  int observations = 0;
  Eigen::VectorXd marker_rmse_3d;  ///< by marker; NaN for a marker without observation
};

/// Metrics of `distances` (postures x markers, as ResidualNorms gives them, m) over the
/// observations in `mask` that were predicted (finite distances). NaN if there are none.
ErrorMetrics ComputeMetrics(const Eigen::MatrixXd& distances, const ObservationMask& mask);

}  // namespace elastocal
