#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/outliers.hpp"

namespace elastocal {

/// Marker errors in the two ways in which the literature says "RMSE", m.
struct ErrorMetrics {
  double rmse_3d = 0.0;          ///< of the distances between measured and predicted positions
  double rmse_coordinate = 0.0;  ///< of their coordinates: rmse_3d / sqrt(3)
  double maximum = 0.0;          ///< largest distance
  int observations = 0;
  Eigen::VectorXd marker_rmse_3d;  ///< by marker; NaN for one without observation
};

/// Metrics of `distances` (postures x markers, as ResidualNorms gives them, m) over the
/// observations in `mask` that were predicted (finite distances). NaN where there are none.
ErrorMetrics ComputeMetrics(const Eigen::MatrixXd& distances, const ObservationMask& mask);

}  // namespace elastocal
