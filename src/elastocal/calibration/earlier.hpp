// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A Gaussian on parameters of joints and legs that an earlier calibration of the robot gives, in
/// SI units. For these parameters it replaces the prior about nominal, which it already contains.
struct EarlierEstimate {
  std::vector<std::string> names;  ///< names of the parameters, each once
  Eigen::VectorXd mean;            ///< deviations from nominal
  Eigen::MatrixXd covariance;      ///< positive definite

  bool empty() const { return names.empty(); }
};

/// The marginal of an earlier estimate for a selection of a model's parameters.
struct EarlierPart {
  /// Which entries of `parameters` the earlier estimate knows, ascending.
  std::vector<int> positions;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  /// Inverse of the covariance. Throws InputError where the covariance is not positive definite.
  Eigen::MatrixXd Information() const;
  /// Matrix W with W'W = Information(). Throws as Information().
  Eigen::MatrixXd Whitening() const;
};

/// `parameters` holds indices of the model's parameters.
EarlierPart PartOf(const EarlierEstimate& earlier, const ErrorModel& model,
                   const std::vector<int>& parameters);

}  // namespace elastocal
