// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observation_residuals.hpp"
#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// Values with what was found to vary, and their uncertainty.
struct ObservationFit {
  ObservedValues values;
  Spread spread;
  std::vector<double> weights;  ///< by observation: 1, less where it is further off than the noise
                                ///< explains, 0 for one that is left out
  std::vector<JointLoads> loads;  ///< by posture
  /// Numbers that told how large each standard deviation of `spread` is, that of its first guess
  /// included; infinite where it is fixed.
  std::vector<double> spread_freedom;
  /// Posterior covariance of the unknowns, SI, and where they stand in it (-1: not estimated): each
  /// unknown of the robot, the first number of each quantity and of each session's effect. Where
  /// the spread is estimated, standard deviations are those whose multiple by Student's t with
  /// `degrees_of_freedom` is the half width of the interval. An unknown that hangs on a source of
  /// which few numbers tell has a t of its own, by Satterthwaite (docs/algorithms.md).
  Eigen::MatrixXd covariance;
  std::vector<int> entry_of_unknown, entry_of_quantity, entry_of_effect;
  double effective_parameters = 0.0;  ///< numbers that the observations determine
  double degrees_of_freedom = 1.0;    ///< of the uncertainty: numbers left over for the noise
  bool settled = false;               ///< whether the variances came to rest
  Termination termination = Termination::kFailure;
  int iterations = 0;
};

/// Fits what is free, from nominal or from `start`, to the observations whose weight is not 0. The
/// standard deviations of all sources that are not fixed follow from the residuals (restricted
/// maximum likelihood by Harville's fixed point, as VarianceComponent has it); each keeps
/// the weight of one number at the standard deviation that it started from (zero offsets of legs,
/// trunk and limbs: at that of all zero offsets together), so that a source of which few numbers
/// tell anything neither vanishes nor explodes.
struct ObservationFitOptions {
  ObservationFreedom freedom = {};
  bool estimate_spread = true;
  /// By medians over observations, which those gone wrong cannot move.
  bool robust = false;
  int max_updates = 300;
};
ObservationFit FitObservations(const ObservedRobot& model, const Observations& observations,
                               const ObservationFit& start, const ObservationFitOptions& options);

/// Where every fit begins: nominal robot, all observations, nothing known of variances.
ObservationFit StartFit(const ObservedRobot& model, const Observations& observations);

/// What the observations alone tell of the unknowns of the robot, all else being unknown with its
/// prior: their information, unknowns x unknowns, SI.
Eigen::MatrixXd RobotInformation(const ObservedRobot& model, const Observations& observations,
                                 const ObservationFit& fit);

/// Huber's weight of an observation by how far it is off: 1 for 99 % of those that have no more
/// than the noise of `spread`, less beyond.
double HuberWeight(const Instrument& instrument, const Eigen::VectorXd& left, const Spread& spread);

/// An observation that contradicts the others: it is left out.
struct ObservationOutlier {
  int observation = 0;
  Eigen::VectorXd left = {};  ///< SI
};

/// A whole estimate: a fit by medians; observations gone wrong are named and left out (further off
/// than Student's t with four degrees of freedom allows); a fit by squares to the rest.
struct ObservedEstimate {
  ObservationFit fit;
  std::vector<ObservationOutlier> outliers = {};
};
ObservedEstimate EstimateObserved(const ObservedRobot& model, const Observations& observations,
                                  const ObservationFreedom& freedom);

}  // namespace elastocal
