#pragma once

#include <vector>

#include "elastocal/calibration/posterior.hpp"

namespace elastocal {

/// An observation that the model, with all its uncertainty, does not explain.
struct Outlier {
  int posture = 0, marker = 0;  ///< of the recording
  double residual = 0.0;        ///< distance between measured and predicted position, m
  /// Mahalanobis distance: residual over what noise and parameter uncertainty make likely.
  double normalised = 0.0;
};

/// Distances between measured and predicted marker positions, m: postures x markers; NaN where a
/// marker was not seen.
Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta);

/// Observations whose squared Mahalanobis distance exceeds the chi-square quantile (3 degrees of
/// freedom) that a clean recording exceeds anywhere with `probability`. The covariance of a
/// residual is marker_sd^2 I - J C J^T where the observation took part in the estimate (`used`),
/// and
/// + J C J^T where it did not.
std::vector<Outlier> FindOutliers(const ErrorModel& model, const Recording& recording,
                                  const ObservationMask& used, const Eigen::VectorXd& delta,
                                  const Posterior& posterior, double marker_sd, double probability);

}  // namespace elastocal
