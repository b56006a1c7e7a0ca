// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"

namespace elastocal {

/// A measurement gone wrong: a marker that contradicts the other markers of its body, or a body
/// that is further off than any error of a model.
struct Outlier {
  int posture = 0, marker = 0;  ///< of the recording
  double residual = 0.0;        ///< distance between measured and predicted position, m
  /// Mahalanobis distance from where the other markers of its body want it or, of a body that is
  /// off as a whole, from the model.
  double normalised = 0.0;
};

/// A body that the model, as far as its markers agree, does not explain in a posture: kept, but at
/// less weight. Here the model is short of something.
struct ShortModel {
  int posture = 0, body = 0;
  double distance = 0.0;    ///< root mean square of its markers' residuals, m
  double normalised = 0.0;  ///< Mahalanobis distance
  double weight = 1.0;
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

/// Finds measurements gone wrong in a fit of the parameters `free`. A clean recording has one named
/// with a chance of `probability`.
///
/// - A marker contradicts the others of its body (three or more) if moving it alone would lower the
///   sum of squares by more than chance does: a score test with the covariance that noise leaves
///   beside the fit. It is not asked whether the model explains the body.
/// - A body is a gross error if even a distribution with tails as heavy as Student's with four
///   degrees of freedom would not have it. Up to there it counts less (RobustWeights) and is kept:
///   what the markers of a body agree on is more likely an error of the model. One marker alone is
///   a body.
/// - A support constraint likewise.
OutlierVerdict FindOutliers(const FitProblem& problem, const Selection& selection,
                            const std::vector<int>& free, const Fit& fit, double probability);

/// Bodies that count less in a fit than by their noise, the furthest off first.
std::vector<ShortModel> FindShortModels(const FitProblem& problem, const Selection& selection,
                                        const Fit& fit);

}  // namespace elastocal
