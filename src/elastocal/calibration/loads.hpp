#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// What loads the elastic parts of the robot in one posture (eq. 5 and 6).
struct PostureLoads {
  JointLoads joints;  ///< empty: nothing is elastic
  /// On the waist, carried by the leg of the posture's footing: force [N] and moment [N.m] at the
  /// origin of the root link, in the axes of the foot. Zero without such a leg.
  /// As measured: what the sensors' biases make of it comes on top.
  Vector6d waist = Vector6d::Zero();
  /// Derivative by the torque bias of each joint of the leg, 6 x joints; zero where the load is not
  /// from the leg's torques.
  Eigen::Matrix<double, 6, Eigen::Dynamic> waist_by_bias;
};

/// What was found on the way.
struct LoadReport {
  std::vector<int> badly_conditioned;  ///< postures with statics for want of a bent knee
  std::vector<int> without_torques;    ///< joints of legs with statics for want of a sensor
};

/// Loads in every posture, for a model with errors `delta` that stands as `placement` says (of a
/// table of postures: upright, T0 being part of `delta`). One entry a posture.
std::vector<PostureLoads> ComputeLoads(const ErrorModel& model, const Recording& recording,
                                       const Eigen::VectorXd& delta, const Placement& placement,
                                       const LoadOptions& options, LoadReport* report = nullptr);

}  // namespace elastocal
