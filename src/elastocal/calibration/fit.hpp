// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/noise.hpp"
#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/calibration/posterior.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {

/// Updates of noise and prior after which a fit counts as not settled.
inline constexpr int kMaxUpdates = 100;

/// What is the same in all steps of a fit. Keeps references.
struct FitProblem {
  const ErrorModel& model;
  const Recording& recording;
  const CalibrationOptions& options;
  std::vector<int> group;  ///< noise group of each posture, see NoiseGroups
};

/// State of a fit: the estimated errors, the noise, the factors of the prior, and the uncertainty.
struct Fit {
  Eigen::VectorXd delta;  ///< one a parameter of the model, SI
  Placement placement = {};
  Noise noise = {};
  RobustWeights weights = {};  ///< weights in the selection that was fitted last
  PriorScale prior_scale = {};
  Posterior posterior = {};  ///< posterior of the fitted parameters
  /// Degrees of freedom of the uncertainty (Satterthwaite), at least 1; infinite where the noise is
  /// given.
  double degrees_of_freedom = 1.0;
  bool settled = true;  ///< noise and prior came to rest in all steps so far

  Termination termination = Termination::kFailure;  ///< how the last solve ended
  std::string message = {};
  int iterations = 0;                           ///< sum over all solves so far
  double initial_cost = 0.0, final_cost = 0.0;  ///< cost at start and end of the last solve
};

/// Initial state of a fit: errors `delta`, poses by registration, and the noise of each group by
/// the median residual.
Fit StartFit(const FitProblem& problem, const Selection& selection, const Eigen::VectorXd& delta);

/// The prior, widened by the fit's factors.
Prior WidenedPrior(const FitProblem& problem, const Fit& fit);

/// The residuals of a fit in its present state, with the objects that they refer to.
struct FitResiduals {
  FitResiduals(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
               const Fit& fit);
  FitResiduals(const FitResiduals&) = delete;
  FitResiduals& operator=(const FitResiduals&) = delete;

  Prior prior;
  Noise noise;
  RobustWeights weights;
  Placement placement;
  std::vector<PostureLoads> loads;
  BodyResiduals body;
};

/// How the noise is found.
enum class Robustness {
  kMoments,  ///< by squares (restricted maximum likelihood)
  kMedians,  ///< by medians, which gross errors do not affect; single markers are weighted, too
};

/// Fits the parameters `free` to the observations in `selection`, starting from `start`; all other
/// parameters keep their value in `start`. Noise, weights and the factors of the prior depend on
/// the solution and enter its weights, so that the fit is a fixed-point iteration. Each update
/// makes a Gauss-Newton step. From the same linearisation it then estimates the noise (the noise of
/// a marker coordinate unless that is given), the weights and the width of the prior (if the
/// options say so). The loads that deflect the robot are computed anew in each update.
///
/// `updates` limits the number of updates; a fit that only starts another needs few.
Fit FitParameters(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const Fit& start, Robustness robustness,
                  int updates = kMaxUpdates);

/// Estimates how errors are correlated within motions, from the residuals of a fit that need not
/// have settled.
void CorrelateMotions(const FitProblem& problem, const Selection& selection,
                      const std::vector<int>& free, Fit& fit);

/// Solves to full precision with noise, weights and prior unchanged, while the loads follow the
/// solution.
void Polish(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            Fit& fit);

/// Returns the covariance of the unknowns in the units of the solver, and stores that of
/// `parameters` (SI) in the fit's posterior.
Eigen::MatrixXd TakeCovariance(const FitProblem& problem, const std::vector<int>& parameters,
                               const NormalEquations& equations, Fit& fit);

/// Computes the posterior of `parameters` with noise, weights and prior unchanged, its cluster
/// factor and degrees of freedom included.
void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit);

}  // namespace elastocal
