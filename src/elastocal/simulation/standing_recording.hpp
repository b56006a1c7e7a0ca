#pragma once

#include <cstdint>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Postures played in one trial.
struct PlayedTrial {
  Trial trial;
  Eigen::MatrixXd q;  ///< postures x coordinates, rad or m
};

struct StandingOptions {
  double marker_sd = 0.2e-3;  ///< noise of a marker coordinate, m
  double torque_sd = 0.0;     ///< noise of a torque, N.m
  /// Joints with torque sensors; their biases are those of the model's parameters.
  std::vector<int> torque_sensors = {};
  std::uint64_t seed = 1;
};

/// Recording of a robot with the errors `delta` that stands on its feet and gives way under its
/// weight: the estimator's own model run backwards (eq. 1 to 7), with noise. The supporting foot of
/// each trial stands somewhere and stays there; in a trial on both feet the waist sways by a few
/// millimetres, and legs feel no torque (how they share the load is not part of the model). Good to
/// show that the estimator finds what it models; it says nothing about what it does not model.
Recording MakeStandingRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                const std::vector<PlayedTrial>& trials,
                                const StandingOptions& options);

}  // namespace elastocal
