// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What is known of a robot from an earlier calibration: a Gaussian on parameters of its joints and
/// legs, in SI units. For these parameters it takes the place of the prior around nominal, which is
/// contained in it.
struct EarlierEstimate {
  std::vector<std::string> names;  ///< of the parameters, each once
  Eigen::VectorXd mean;            ///< deviations from nominal
  Eigen::MatrixXd covariance;      ///< positive definite

  bool empty() const { return names.empty(); }
};

/// The part of an earlier estimate that is about some parameters of a model; the others are
/// integrated out.
struct EarlierPart {
  std::vector<int> positions;  ///< of the known parameters among `parameters`, ascending
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  /// Inverse of the covariance. Throws InputError where it is not positive definite.
  Eigen::MatrixXd Information() const;
  /// W with W'W = Information().
  Eigen::MatrixXd Whitening() const;
};

/// `parameters`: indices into the model's.
EarlierPart PartOf(const EarlierEstimate& earlier, const ErrorModel& model,
                   const std::vector<int>& parameters);

}  // namespace elastocal
