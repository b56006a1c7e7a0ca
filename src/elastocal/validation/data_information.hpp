// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Log-likelihood of a recording in its model's parameters x, to first order and without the prior:
/// log p(data | x) = vector' x - x' information x / 2 + constant. Poses are integrated out.
/// Compliances at their bound stay there and are left out.
struct DataInformation {
  std::vector<int> parameters;  ///< indices into the model's
  Eigen::VectorXd unit;         ///< unit of each in SI (ParameterScale); x is in these units
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;
};

/// Computes the log-likelihood from a fit. `fitted_with` is the earlier estimate that the fit used
/// as prior. The information is divided by the cluster factor (Posterior::cluster_factor), because
/// residuals of a posture are correlated.
DataInformation InformationOfData(const CalibrationResult& estimate,
                                  const EarlierEstimate& fitted_with);

/// Covariance of the same parameters, in the same units, before the data: that of the earlier
/// estimate for parameters that it knows, and of the prior for the others.
Eigen::MatrixXd CovarianceBefore(const CalibrationResult& estimate, const DataInformation& data,
                                 const EarlierEstimate& earlier);

/// Mean of the same parameters before the data.
Eigen::VectorXd MeanBefore(const CalibrationResult& estimate, const DataInformation& data,
                           const EarlierEstimate& earlier);

/// Logarithm of p(data) if the parameters are distributed as N(mean, covariance) before the data,
/// in the units of the data. A constant that does not depend on mean and covariance is left out.
double LogEvidence(const DataInformation& data, const Eigen::VectorXd& mean,
                   const Eigen::MatrixXd& covariance);

}  // namespace elastocal
