// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"

namespace elastocal {

/// An observation that has gone wrong: a marker that contradicts the other markers of its body, or
/// a marker of a body that is further off than any error of a model.
struct Outlier {
  int posture = 0, marker = 0;  ///< indices in the recording
  double residual = 0.0;        ///< distance between measured and predicted position, m
  /// Mahalanobis distance from the position that the other markers of its body predict. For a body
  /// that is off as a whole: from the position that the model predicts.
  double normalised = 0.0;
};

/// A body in a posture that the model does not explain, although its markers agree with each other.
/// It is kept at less weight.
struct ShortModel {
  int posture = 0, body = 0;
  double distance = 0.0;    ///< root mean square of its markers' residuals, m
  double normalised = 0.0;  ///< Mahalanobis distance
  double weight = 1.0;
};

/// A posture whose support constraint does not hold: the waist is further from where the leg on its
/// foot puts it than the model's uncertainty allows.
struct LooseFooting {
  int posture = 0;
  double distance = 0.0;    ///< distance of the waist from where the leg puts it, m
  double normalised = 0.0;  ///< Mahalanobis distance
};

/// Outliers and loose footings of a fit.
struct OutlierVerdict {
  std::vector<Outlier> markers;
  std::vector<LooseFooting> footings;
};

/// Predicted positions of the markers of a recording in a frame fixed to the waist, m: postures x 3
/// N_M.
Eigen::MatrixXd PredictedPositions(const ErrorModel& model, const Recording& recording,
                                   const Eigen::VectorXd& delta,
                                   const CalibrationOptions& options = {});

/// Distances between measured and predicted marker positions, m: postures x markers; NaN where a
/// marker was not seen. `positions` as Recording::markers.
Eigen::MatrixXd MarkerDistances(const Recording& recording, const Eigen::MatrixXd& positions);

/// Distances between measured positions and PredictedPositions, m, for a recording in a frame fixed
/// to the waist.
Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta, const CalibrationOptions& options = {});

/// Finds outliers in a fit of the parameters `free`. In a recording without outliers, at least one
/// is named with probability `probability`.
///
/// - A marker contradicts the others of its body (three or more) if displacing it alone would lower
///   the sum of squares by more than chance does. This is a score test with the covariance of the
///   residuals after the fit. It does not depend on whether the model explains the body.
/// - A body is a gross error if it is further off than even Student's distribution with four
///   degrees of freedom allows. Up to that limit it counts less (RobustWeights) and is kept,
///   because what the markers of a body agree on is more likely an error of the model. A marker
///   that is alone is a body.
/// - A support constraint is judged as a body is.
OutlierVerdict FindOutliers(const FitProblem& problem, const Selection& selection,
                            const std::vector<int>& free, const Fit& fit, double probability);

/// Bodies that count less than 1 in a fit, the furthest off first.
std::vector<ShortModel> FindShortModels(const FitProblem& problem, const Selection& selection,
                                        const Fit& fit);

}  // namespace elastocal
