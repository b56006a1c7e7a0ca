// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Uncertainty of estimated parameters around a solution, to first order: the inverse of the
/// information J^T J that observations, constraints and prior give together, poses of waist and
/// feet being unknown as well.
struct Posterior {
  std::vector<int> parameters;  ///< indices into the model's, ascending
  Eigen::MatrixXd covariance;   ///< of these, in products of their SI units
  /// What the data alone tell of them, without the prior: inverse products of SI units.
  Eigen::MatrixXd data_information;
  /// Number of parameters (poses included) that the data, rather than the prior, determine: trace
  /// of the share of the data in the information.
  double effective_parameters = 0.0;

  /// Variance of the estimates by the scatter of the postures (cluster-robust), over that by the
  /// noise model; above 1 it is in the covariance.
  double cluster_factor = 1.0;

  Eigen::VectorXd StandardDeviations() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Inverse of a positive definite matrix.
Eigen::MatrixXd InverseOfInformation(const Eigen::MatrixXd& information);

/// Covariance of `parameters`, the first unknowns, from that of all unknowns of the solver.
Eigen::MatrixXd ParameterCovariance(const ErrorModel& model, const std::vector<int>& parameters,
                                    const Eigen::MatrixXd& covariance);

/// Two parameters that the data can hardly tell apart.
struct Correlation {
  int first = 0, second = 0;  ///< indices into the model's parameters
  double coefficient = 0.0;
};

/// Pairs with an absolute correlation of at least `threshold`, the strongest first.
std::vector<Correlation> StrongCorrelations(const Posterior& posterior, double threshold);

}  // namespace elastocal
