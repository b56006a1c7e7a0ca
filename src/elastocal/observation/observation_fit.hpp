// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observation_residuals.hpp"
#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// Estimated values with their standard deviations by source, and their uncertainty.
struct ObservationFit {
  ObservedValues values;
  Spread spread;
  /// By observation: 1, less where it is further off than the noise explains, 0 if it is left out.
  std::vector<double> weights;
  std::vector<JointLoads> loads;  ///< by posture
  /// Number of numbers from which each standard deviation of `spread` was estimated, that of its
  /// first guess included; infinite where it is fixed.
  std::vector<double> spread_freedom;
  /// Posterior covariance of the unknowns, SI, and their entries in it (-1: not estimated): each
  /// unknown of the robot, and the first number of each quantity and of each session's effect.
  /// Where the spread is estimated, the standard deviations are scaled so that their multiple by
  /// Student's t with `degrees_of_freedom` is the half width of the interval. An unknown that
  /// depends on a source with few numbers has a t of its own, by Satterthwaite
  /// (docs/algorithms.md).
  Eigen::MatrixXd covariance;
  std::vector<int> entry_of_unknown, entry_of_quantity, entry_of_effect;
  double effective_parameters = 0.0;  ///< count of numbers that the observations determine
  double degrees_of_freedom = 1.0;  ///< numbers left for the noise, on which the uncertainty rests
  bool settled = false;             ///< the variances came to rest
  Termination termination = Termination::kFailure;
  int iterations = 0;
};

/// Settings of FitObservations.
struct ObservationFitOptions {
  ObservationFreedom freedom = {};
  bool estimate_spread = true;
  /// Estimate the noise by medians, which outliers do not affect.
  bool robust = false;
  int max_updates = 300;
};
/// Fits what is free, starting from `start`, to the observations whose weight is not 0. The
/// standard deviations of all sources that are not fixed are estimated from the residuals
/// (restricted maximum likelihood by Harville's fixed point, as in VarianceComponent). Each keeps
/// the weight of Source::own_weight numbers at its first guess (zero offsets of legs, trunk and
/// limbs: at that of all zero offsets together), so that a source with few numbers neither vanishes
/// nor explodes.
ObservationFit FitObservations(const ObservedRobot& model, const Observations& observations,
                               const ObservationFit& start, const ObservationFitOptions& options);

/// Start of every fit: nominal robot, all observations, first guesses of the standard deviations.
ObservationFit StartFit(const ObservedRobot& model, const Observations& observations);

/// Information of the observations alone about the unknowns of the robot, with all else unknown
/// under its prior: unknowns x unknowns, SI.
Eigen::MatrixXd RobotInformation(const ObservedRobot& model, const Observations& observations,
                                 const ObservationFit& fit);

/// Huber's weight of an observation by its distance in units of the noise of `spread`: 1 up to the
/// distance that 99 % of correct observations have, less beyond.
double HuberWeight(const Instrument& instrument, const Eigen::VectorXd& left, const Spread& spread);

/// An observation that contradicts the others and is left out.
struct ObservationOutlier {
  int observation = 0;
  Eigen::VectorXd left = {};  ///< residual, SI
};

/// Result of EstimateObserved.
struct ObservedEstimate {
  ObservationFit fit;
  std::vector<ObservationOutlier> outliers = {};
};
/// Makes a complete estimate: a fit by medians, after which outliers (further off than Student's t
/// with four degrees of freedom allows) are named and left out, and a fit by squares to the rest.
ObservedEstimate EstimateObserved(const ObservedRobot& model, const Observations& observations,
                                  const ObservationFreedom& freedom);

}  // namespace elastocal
