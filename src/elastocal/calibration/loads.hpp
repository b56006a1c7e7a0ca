// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/placement.hpp"
#include "elastocal/robot/posture_loads.hpp"

namespace elastocal {

/// Loads that had to be computed by statics.
struct LoadReport {
  /// Postures in which torques do not determine the load, because the knee is straight.
  std::vector<int> badly_conditioned;
  std::vector<int> without_torques;  ///< joints of legs whose torque was not measured
};

/// Measured torques in a posture and, standing on `leg` of the model, the measured wrench of a
/// sensor on that leg. -1: on no leg.
MeasuredLoads MeasuredLoadsOf(const ErrorModel& model, const Recording& recording, int posture,
                              int leg);

/// Loads in every posture (one entry each) of a model with errors `delta` that stands as
/// `placement` says. In a posture table the robot stands upright, and T0 is part of `delta`.
/// `report`, if given, receives where statics replaced measurements.
std::vector<PostureLoads> ComputeLoads(const ErrorModel& model, const Recording& recording,
                                       const Eigen::VectorXd& delta, const Placement& placement,
                                       const LoadOptions& options, LoadReport* report = nullptr);

}  // namespace elastocal
