#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"

namespace elastocal {

/// An observation that the model, with all its uncertainty, does not explain.
struct Outlier {
  int posture = 0, marker = 0;  ///< of the recording
  double residual = 0.0;        ///< distance between measured and predicted position, m
  /// Mahalanobis distance: residual over what noise and parameter uncertainty make likely.
  double normalised = 0.0;
};

/// A posture whose support constraint does not hold: the waist is not where the leg on its foot
/// puts it, whatever the model's uncertainty.
struct LooseFooting {
  int posture = 0;
  double distance = 0.0;    ///< of the waist from there, m
  double normalised = 0.0;  ///< Mahalanobis distance
};

struct OutlierVerdict {
  std::vector<Outlier> markers;
  std::vector<LooseFooting> footings;
};

/// Where the markers of a recording in a frame fixed to the waist should be, m: postures x 3 N_M.
Eigen::MatrixXd PredictedPositions(const ErrorModel& model, const Recording& recording,
                                   const Eigen::VectorXd& delta,
                                   const CalibrationOptions& options = {});

/// Distances between measured and predicted marker positions, m: postures x markers; NaN where a
/// marker was not seen. `positions` as Recording::markers.
Eigen::MatrixXd MarkerDistances(const Recording& recording, const Eigen::MatrixXd& positions);

/// Both together, for a recording in a frame fixed to the waist.
Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta, const CalibrationOptions& options = {});

/// Observations that are further from the model than any observation of a clean recording would be,
/// but for a chance of `probability`, in a fit with its posterior up to date. The squared
/// Mahalanobis distance is judged, with the covariance that noise and the uncertainty of the
/// prediction give: noise less what the fit explains where the observation took part in the
/// estimate
/// (`used`), plus it where it did not. Its quantile is that of the chi-square distribution where
/// the noise is known; where it was estimated, of the beta distribution (the observation is part of
/// the estimate) or of Fisher's F (it is not). Constraints are judged likewise.
OutlierVerdict FindOutliers(const Fit& fit, const std::vector<int>& group, const Selection& used,
                            double probability);

}  // namespace elastocal
