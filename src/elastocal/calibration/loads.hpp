// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/placement.hpp"
#include "elastocal/robot/posture_loads.hpp"

namespace elastocal {

/// What was found on the way.
struct LoadReport {
  std::vector<int> badly_conditioned;  ///< postures with statics for want of a bent knee
  std::vector<int> without_torques;    ///< joints of legs with statics for want of a sensor
};

/// What the robot felt in a posture of a recording, standing on a leg of the model (-1: on none).
MeasuredLoads MeasuredLoadsOf(const ErrorModel& model, const Recording& recording, int posture,
                              int leg);

/// Loads in every posture, for a model with errors `delta` that stands as `placement` says (of a
/// table of postures: upright, T0 being part of `delta`). One entry a posture.
std::vector<PostureLoads> ComputeLoads(const ErrorModel& model, const Recording& recording,
                                       const Eigen::VectorXd& delta, const Placement& placement,
                                       const LoadOptions& options, LoadReport* report = nullptr);

}  // namespace elastocal
