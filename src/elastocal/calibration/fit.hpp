#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/noise.hpp"
#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/calibration/posterior.hpp"
#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

inline constexpr int kMaxUpdates = 50;  ///< of noise and prior before a fit counts as unsettled

/// What stays the same while parameters are fitted in several steps. Keeps references.
struct FitProblem {
  const ErrorModel& model;
  const Recording& recording;
  const CalibrationOptions& options;
  std::vector<int> group;  ///< of each posture, see NoiseGroups
};

/// Which observations and constraints take part.
struct Selection {
  ObservationMask markers;
  std::vector<char> tied;  ///< by posture: whether its support constraint takes part
};

/// All markers seen, and all constraints.
Selection SelectAll(const Recording& recording);

/// Estimated errors with the noise that they leave, how far they go beyond the prior, and their
/// uncertainty.
struct Fit {
  Eigen::VectorXd delta;  ///< one a parameter of the model, SI
  Placement placement = {};
  Noise noise = {};
  PriorScale prior_scale = {};
  Posterior posterior = {};         ///< of the fitted parameters
  double degrees_of_freedom = 1.0;  ///< of the residuals, at least 1; infinite: the noise is given
  bool settled = true;              ///< whether noise and prior came to rest, in all steps so far

  Termination termination = Termination::kFailure;  ///< of the last solve
  std::string message = {};
  int iterations = 0;                           ///< of all solves so far
  double initial_cost = 0.0, final_cost = 0.0;  ///< of the last solve

  /// Of the last posterior: what each residual block is about, and its value in units of its
  /// standard deviation.
  std::vector<BodyResiduals::Meaning> meanings = {};
  std::vector<Eigen::VectorXd> residuals = {};
};

/// A fit that has not begun: nothing known but `delta`, the first guess of where the robot stands,
/// and the noise by the median residual there.
Fit StartFit(const FitProblem& problem, const Selection& selection, const Eigen::VectorXd& delta);

/// Fits the parameters `free` to the observations in `selection`, from `start`; the others stay as
/// there. Noise and prior weigh against each other and both follow from the solution, so it is a
/// fixed-point iteration: a Gauss-Newton step, then, from the same linearisation, the noise (that
/// of a marker coordinate unless it is given) and the width of the prior (if asked to), and again.
/// The loads that bend the robot follow along. Of the posterior, parameters and covariance, and the
/// degrees of freedom, are those of the last step; see UpdatePosterior and, for the last digits,
/// Polish.
///
/// `robust`: under Cauchy's loss and with the noise by the median, which gross errors cannot move;
/// then the posterior is complete.
/// `updates`: of noise and prior at most; a start for another fit needs few.
Fit FitParameters(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const Fit& start, bool robust,
                  int updates = kMaxUpdates);

/// Solves to the last digit, with noise and prior as they are and loads as the solution has them.
void Polish(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            Fit& fit);

/// Residuals, and uncertainty of `parameters`, with noise and prior as they are.
void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit);

/// Joint parameters of the fit about which the data say hardly more than the prior
/// (CalibrationOptions::support_threshold; without a prior: less than 0.1 rad or m). Found one by
/// one: the worst is held, which may give others the support that they shared with it, and so on;
/// so a combination that the data determine well is never held altogether.
std::vector<int> UnsupportedParameters(const FitProblem& problem, const Fit& fit);

}  // namespace elastocal
