#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/residuals.hpp"

namespace elastocal {

/// Uncertainty of estimated parameters around a solution, to first order.
struct Posterior {
  std::vector<int> parameters;  ///< indices into the model's, ascending
  Eigen::MatrixXd covariance;   ///< of these; rad^2, rad m, m^2
  /// Number of parameters (poses included) that the data, rather than the prior, determine: trace
  /// of the share of the data in the information. What is left of the number of equations after
  /// subtracting it is the degrees of freedom of the residuals.
  double effective_parameters = 0.0;
  /// By residual block: covariance of its prediction, in units of the residual's own variance.
  std::vector<Eigen::MatrixXd> explained;

  Eigen::VectorXd StandardDeviations() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Uncertainty of `parameters`, the unknowns of `residuals` in that order, at `x`: inverse of the
/// information J^T J that observations, constraints and prior give together, poses of waist and
/// feet being unknown as well. A parameter without prior gets one of 1 m or 1 rad here (not in the
/// estimate), so that one that was never excited has a large uncertainty instead of none.
Posterior ComputePosterior(const ErrorModel& model, BodyResiduals& residuals,
                           const std::vector<int>& parameters, const Eigen::VectorXd& x,
                           const Prior& prior);

/// The information about unknowns in the solver's units, poses behind the parameters, with the
/// vague prior just said.
Eigen::MatrixXd WithVaguePrior(const ErrorModel& model, const std::vector<int>& parameters,
                               const Prior& prior, Eigen::MatrixXd information);

/// Parameters and covariance of a posterior from such information; returns its inverse, in the
/// solver's units.
Eigen::MatrixXd TakeCovariance(const ErrorModel& model, const std::vector<int>& parameters,
                               const Prior& prior, const Eigen::MatrixXd& information,
                               Posterior& posterior);

/// Two parameters that the data can hardly tell apart.
struct Correlation {
  int first = 0, second = 0;  ///< indices into the model's parameters
  double coefficient = 0.0;
};

/// Pairs with an absolute correlation of at least `threshold`, the strongest first.
std::vector<Correlation> StrongCorrelations(const Posterior& posterior, double threshold);

}  // namespace elastocal
