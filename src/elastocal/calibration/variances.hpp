// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {

inline constexpr double kSmallestMarkerSd = 1e-6;  ///< m: what a file of rounded numbers leaves

/// What the residuals of a fit say about one source of noise in one group of postures, all in units
/// of the standard deviations that they had.
struct VarianceComponent {
  double squares = 0.0;       ///< of the residuals, each by the source's share in its variance
  double rows = 0.0;          ///< sum of the shares
  double explained = 0.0;     ///< part of `rows` that the fit explains
  double weight = 0.0;        ///< sum of squared shares: of how many residuals it is the variance
  std::vector<double> means;  ///< `squares` over `rows` of each body or constraint

  /// By how much the standard deviation has to be multiplied; by the median over bodies where
  /// outliers may be among the residuals.
  double Factor(Robustness robustness) const;
};

/// By group and source.
using VarianceComponents = std::vector<std::array<VarianceComponent, kNoiseSourceCount>>;

/// What is left of the variance of a block's rows, if the waist's pose alone were estimated
/// (ExplainedRows::by_nuisance) and a row counts as `counts` (BodyResiduals::Counts): its errors
/// are smaller than its standard deviation by the root of it, but what the other rows of the
/// posture make of the pose is not.
Eigen::ArrayXd LeftByPose(const ExplainedRows& explained, int block, const Eigen::ArrayXd& counts);

/// Components from the residuals as last evaluated.
VarianceComponents CollectComponents(const FitProblem& problem, const Selection& selection,
                                     const Noise& noise, const BodyResiduals& residuals,
                                     const ExplainedRows& explained);

/// The noise that components leave which were found with the noise `before`: restricted maximum
/// likelihood, by Harville's fixed point. What the options give stays as given. A group whose
/// bodies all have a single marker cannot tell errors of the model from noise of the cameras: all
/// counts as the latter.
Noise EstimateNoise(const CalibrationOptions& options, const Noise& before,
                    const VarianceComponents& components, Robustness robustness);

/// Huber's weights: 1 within the distance that one body in a hundred exceeds by chance, beyond it
/// falling with the distance.
RobustWeights EstimateWeights(const FitProblem& problem, const Selection& selection,
                              const Noise& noise, const BodyResiduals& residuals,
                              Robustness robustness);

/// How far the parameters go beyond the prior, by the fit's estimates and their posterior
/// covariance (MacKay's update). Never narrower than the prior that was given.
PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit);

/// Degrees of freedom of the uncertainty of the parameters, to which each source contributes by
/// what of it the fit explains (Satterthwaite 1946); infinite where the noise is given.
double DegreesOfFreedom(const CalibrationOptions& options, const VarianceComponents& components);

}  // namespace elastocal
