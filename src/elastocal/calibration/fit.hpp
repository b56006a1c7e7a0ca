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

inline constexpr int kMaxUpdates = 100;  ///< of noise and prior before a fit counts as unsettled

/// What stays the same while parameters are fitted in several steps. Keeps references.
struct FitProblem {
  const ErrorModel& model;
  const Recording& recording;
  const CalibrationOptions& options;
  std::vector<int> group;  ///< of each posture, see NoiseGroups
};

/// Estimated errors with the noise that they leave, how far they go beyond the prior, and their
/// uncertainty.
struct Fit {
  Eigen::VectorXd delta;  ///< one a parameter of the model, SI
  Placement placement = {};
  Noise noise = {};
  RobustWeights weights = {};  ///< of bodies and constraints of the selection last fitted to
  PriorScale prior_scale = {};
  Posterior posterior = {};         ///< of the fitted parameters
  double degrees_of_freedom = 1.0;  ///< of their uncertainty, at least 1; infinite: the noise is
                                    ///< given (Satterthwaite)
  bool settled = true;              ///< whether noise and prior came to rest, in all steps so far

  Termination termination = Termination::kFailure;  ///< of the last solve
  std::string message = {};
  int iterations = 0;                           ///< of all solves so far
  double initial_cost = 0.0, final_cost = 0.0;  ///< of the last solve
};

/// A fit that has not begun: nothing known but `delta`, the first guess of where the robot stands,
/// and the noise by the median residual there.
Fit StartFit(const FitProblem& problem, const Selection& selection, const Eigen::VectorXd& delta);

/// The prior as wide as the fit has it.
Prior WidenedPrior(const FitProblem& problem, const Fit& fit);

/// The residuals of a fit as it stands, with all that they refer to.
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
  kMedians,  ///< by medians, which gross errors cannot move; and single markers count less, too
};

/// Fits the parameters `free` to the observations in `selection`, from `start`; the others stay as
/// there. Noise, weights and prior follow from the solution and weigh in it, so it is a fixed-point
/// iteration: a Gauss-Newton step, then, from the same linearisation, noise (that of a marker
/// coordinate unless it is given), weights and the width of the prior (if asked to), and again. The
/// loads that bend the robot follow along.
///
/// `updates`: of noise and prior at most; a start for another fit needs few.
Fit FitParameters(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const Fit& start, Robustness robustness,
                  int updates = kMaxUpdates);

/// How errors are correlated in motions, by what a fit leaves that need not have settled.
void CorrelateMotions(const FitProblem& problem, const Selection& selection,
                      const std::vector<int>& free, Fit& fit);

/// Solves to the last digit, with noise, weights and prior as they are and loads as the solution
/// has them.
void Polish(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            Fit& fit);

/// Covariance of the unknowns in the units of the solver; that of `parameters` goes into the fit's
/// posterior.
Eigen::MatrixXd TakeCovariance(const FitProblem& problem, const std::vector<int>& parameters,
                               const NormalEquations& equations, Fit& fit);

/// Uncertainty of `parameters`, with noise, weights and prior as they are.
void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit);

}  // namespace elastocal
