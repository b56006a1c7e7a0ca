// SPDX-License-Identifier: Apache-2.0
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

/// Makes a recording of a robot with the errors `delta` that stands on its feet and is deflected by
/// its weight. It uses the estimator's own model forwards (eq. 1 to 7), with noise. The support
/// foot of each trial stands flat at a random place of one level floor and stays there. In a trial
/// on both feet the waist sways by a few millimetres, and torques in the legs are not simulated
/// (how two legs share the load is not part of the model). Such a recording shows that the
/// estimator finds what it models, and says nothing about what it does not model.
Recording MakeStandingRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                const std::vector<PlayedTrial>& trials,
                                const StandingOptions& options);

}  // namespace elastocal
