// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {

inline constexpr double kSmallestMarkerSd = 1e-6;  ///< m: rounding of the numbers in a file

/// Sums over the residuals of one group of postures for one source of noise. Residuals are in units
/// of the standard deviations with which they were computed.
struct VarianceComponent {
  double squares = 0.0;    ///< squared residuals, each times the source's share in its variance
  double rows = 0.0;       ///< sum of the shares, each times the row's count
  double explained = 0.0;  ///< part of `rows` that the fit explains
  /// sum of squared shares: number of residuals from which the variance is estimated
  double weight = 0.0;
  std::vector<double> means;  ///< `squares` over `rows` of each body or constraint

  /// Factor by which the standard deviation has to be multiplied. With kMedians it is found by the
  /// median over bodies, because outliers may be among the residuals.
  double Factor(Robustness robustness) const;
};

/// Components by group and source.
using VarianceComponents = std::vector<std::array<VarianceComponent, kNoiseSourceCount>>;

/// Share of a row's variance that is left after the waist's pose alone is estimated
/// (ExplainedRows::by_nuisance), where a row counts as `counts` (BodyResiduals::Counts). The counts
/// reduce the row's own error, but not what the other rows of the posture contribute through the
/// pose.
Eigen::ArrayXd LeftByPose(const ExplainedRows& explained, int block, const Eigen::ArrayXd& counts);

/// Computes the components from the residuals as last evaluated.
VarianceComponents CollectComponents(const FitProblem& problem, const Selection& selection,
                                     const Noise& noise, const BodyResiduals& residuals,
                                     const ExplainedRows& explained);

/// Estimates the noise from components that were found with the noise `before`: restricted maximum
/// likelihood, by Harville's fixed point. Values that the options give are kept. A group whose
/// bodies all have a single marker cannot tell errors of the model from noise of the cameras; all
/// of it then counts as noise of the cameras.
Noise EstimateNoise(const CalibrationOptions& options, const Noise& before,
                    const VarianceComponents& components, Robustness robustness);

/// Huber's weights: 1 within the distance that one body in a hundred exceeds by chance, and
/// decreasing with the distance beyond. Single markers are weighted by themselves only with
/// kMedians.
RobustWeights EstimateWeights(const FitProblem& problem, const Selection& selection,
                              const Noise& noise, const BodyResiduals& residuals,
                              Robustness robustness);

/// Factors by which the prior has to be widened, from the fit's estimates and their posterior
/// covariance (MacKay's update): at least 1, at most MostWidening. A group of which the data
/// determine less than one parameter keeps its factor.
PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit);

/// Degrees of freedom of the parameters' uncertainty, at least 1. Each source contributes by what
/// the fit explains of it (Satterthwaite 1946). Infinite where the noise is given.
double DegreesOfFreedom(const CalibrationOptions& options, const VarianceComponents& components);

}  // namespace elastocal
