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

/// How sure the noise of a marker coordinate is.
struct NoiseLevel {
  double marker_sd = 0.0;  ///< m
  /// Degrees of freedom of the residuals that it was estimated from; infinite where it was given.
  double degrees_of_freedom = 0.0;
};

/// Observations that are further from the model than any observation of a clean recording would be,
/// but for a chance of `probability`. The squared Mahalanobis distance is judged, with a covariance
/// of sd^2 I less J C J^T where the observation took part in the estimate (`used`), and plus J C
/// J^T where it did not. Its quantile is that of the chi-square distribution (3 degrees of freedom)
/// where the noise is known; where it was estimated, of the beta distribution (the observation is
/// part of the estimate) or of Fisher's F (it is not).
std::vector<Outlier> FindOutliers(const ErrorModel& model, const Recording& recording,
                                  const ObservationMask& used, const Eigen::VectorXd& delta,
                                  const Posterior& posterior, const NoiseLevel& noise,
                                  double probability);

}  // namespace elastocal
