// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// How a recording of static postures is generated.
struct SyntheticOptions {
  int postures = 60;          ///< drawn uniformly within the joint limits
  double marker_sd = 0.2e-3;  ///< noise of a marker coordinate, m (paper section 1: about 0.2 mm)
  std::uint64_t seed = 1;
};

/// Draws an error for each of the given parameters from a normal distribution with the standard
/// deviation for its kind [rad or m]. The result has one entry for each parameter of the model; the
/// others are zero.
Eigen::VectorXd DrawErrors(const ErrorModel& model, const std::vector<int>& parameters,
                           const std::map<ParameterKind, double>& sd, std::uint64_t seed);

/// Makes a recording of a robot with the errors `delta`, by the estimator's own forward kinematics,
/// with noise. Such a recording shows that the estimator finds what it models, and says nothing
/// about what it does not model.
Recording MakeSyntheticRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                 const SyntheticOptions& options);

}  // namespace elastocal
