// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// What the data of a recording say of its model's parameters x, to first order and whatever was
/// known beforehand: log p(data | x) = vector' x - x' information x / 2 + a constant. Poses are
/// integrated out; compliances that lie at their bound stay there and are left out.
struct DataInformation {
  std::vector<int> parameters;  ///< indices into the model's
  Eigen::VectorXd unit;         ///< of each, in SI (ParameterScale); x is in these
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;
};

/// `fitted_with`: the earlier estimate that `estimate` was fitted with. What the residuals of a
/// posture share makes the information less (Posterior::cluster_factor).
DataInformation InformationOfData(const CalibrationResult& estimate,
                                  const EarlierEstimate& fitted_with);

/// Covariance of the same parameters in the same units before the data: the prior's, and of those
/// that an earlier estimate knows, that one's.
Eigen::MatrixXd CovarianceBefore(const CalibrationResult& estimate, const DataInformation& data,
                                 const EarlierEstimate& earlier);

/// Their mean before the data.
Eigen::VectorXd MeanBefore(const CalibrationResult& estimate, const DataInformation& data,
                           const EarlierEstimate& earlier);

/// Logarithm of p(data | N(mean, covariance) before them), in the units of the data, less a
/// constant that is the same for all.
double LogEvidence(const DataInformation& data, const Eigen::VectorXd& mean,
                   const Eigen::MatrixXd& covariance);

}  // namespace elastocal
