// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Uncertainty of estimated parameters about a solution, to first order: the inverse of the
/// information J^T J of observations, constraints and prior together, with the poses of waist and
/// feet as further unknowns.
struct Posterior {
  std::vector<int> parameters;  ///< indices into the model's, ascending
  Eigen::MatrixXd covariance;   ///< covariance of these, in products of their SI units
  /// Information of the data alone on these parameters, without the prior; inverse products of SI
  /// units.
  Eigen::MatrixXd data_information;
  /// Number of unknowns (poses included) that the data determine rather than the prior: the trace
  /// of the data's share in the information.
  double effective_parameters = 0.0;

  /// Variance of the estimates by the scatter of the postures (cluster-robust) over the variance by
  /// the noise model. If it is above 1, the covariance contains it.
  double cluster_factor = 1.0;

  Eigen::VectorXd StandardDeviations() const { return covariance.diagonal().cwiseSqrt(); }
};

/// Inverse of a positive definite matrix.
Eigen::MatrixXd InverseOfInformation(const Eigen::MatrixXd& information);

/// Covariance of `parameters` in SI units, from that of all unknowns in the units of the solver, of
/// which they are the first.
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
