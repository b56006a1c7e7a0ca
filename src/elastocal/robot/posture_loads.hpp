// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Source of the load on the waist.
enum class LoadSource {
  kTorques,  ///< the leg's torque sensors (eq. 6); statics replace a missing one
  kWrench,   ///< a force-torque sensor in the leg, if there is one; else as kTorques
  kStatics,  ///< gravity on the calibrated model
};

struct LoadOptions {
  LoadSource source = LoadSource::kTorques;
  /// Largest condition number of the leg's Jacobian. Above it (a straight knee), torques do not
  /// tell the load, and statics replace them in that posture.
  double largest_condition = 100.0;
};

/// Loads that the robot's sensors measured in one posture.
struct MeasuredLoads {
  Eigen::VectorXd torques;  ///< by joint of the tree, N.m or N; NaN without sensor; empty: none
  int wrench_link = -1;     ///< link of a force-torque sensor in the support leg; -1: none
  Vector6d wrench = Vector6d::Zero();  ///< see LoadFromWrench
};

/// Loads of the elastic parts of the robot in one posture (eq. 5 and 6).
struct PostureLoads {
  JointLoads joints;  ///< empty: nothing is elastic
  /// Load on the waist that the support leg carries: force [N] and moment [N.m] at the origin of
  /// the root link, in the axes of the foot. Zero without a support leg. As measured: the biases of
  /// the sensors are not taken off.
  Vector6d waist = Vector6d::Zero();
  /// Derivative of `waist` by the torque bias of each joint of the leg, 6 x joints; zero if the
  /// load is not from the leg's torques.
  Eigen::Matrix<double, 6, Eigen::Dynamic> waist_by_bias;
  bool badly_conditioned = false;  ///< statics were used because the knee is straight
  std::vector<int>
      without_torques;  ///< joints of the leg without sensor, for which statics were used

  /// The load on the waist with the sensors' biases (geometry.torque_bias) taken off.
  Vector6d WaistLoad(const ErrorModel& model, const Geometry& geometry, int leg) const;
};

/// Loads of the deflected robot (GravityLoads, in two steps) whose waist is where `geometry` has it
/// (PlaceWaist), and which stands on leg `leg` of the model or, for -1, has its waist held still.
/// `gravity_ref` is in the reference frame, m/s^2.
PostureLoads LoadPosture(const ErrorModel& model, const Geometry& geometry,
                         const Eigen::VectorXd& q, int leg, const MeasuredLoads& measured,
                         const Eigen::Vector3d& gravity_ref, const LoadOptions& options);

/// Sets JointLoads::shapes: the functions that the corrections of the model multiply in a posture
/// (EvaluateShapes). PostureHistory::root_moment of `history` is computed here.
void AddShapes(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
               const Eigen::Vector3d& gravity_ref, PostureHistory history, JointLoads& loads);

}  // namespace elastocal
