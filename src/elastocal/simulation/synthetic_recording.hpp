#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What a recording of static postures is generated with.
struct SyntheticOptions {
  int postures = 60;          ///< drawn uniformly within the joint limits
  double marker_sd = 0.2e-3;  ///< noise of a marker coordinate, m (paper section 1: about 0.2 mm)
  std::uint64_t seed = 1;
};

/// Draws an error for each of the given parameters: normal, with the standard deviation given for
/// its kind [rad or m]; all others zero. One entry a parameter of the model.
Eigen::VectorXd DrawErrors(const ErrorModel& model, const std::vector<int>& parameters,
                           const std::map<ParameterKind, double>& sd, std::uint64_t seed);

/// Recording of a robot with the errors `delta`: our own forward kinematics run backwards, with
/// noise. Good to show that the estimator finds what it models; it says nothing about what it does
/// not model.
Recording MakeSyntheticRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                 const SyntheticOptions& options);

}  // namespace elastocal
