#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Where the load on the waist is taken from.
enum class LoadSource {
  kTorques,  ///< the leg's torque sensors (eq. 6); a missing one is replaced by the statics
  kWrench,   ///< an ankle's force-torque sensor, where there is one; else as kTorques
  kStatics,  ///< gravity on the calibrated model
};

struct LoadOptions {
  LoadSource source = LoadSource::kTorques;
  /// Where the leg's Jacobian is worse conditioned than this (a straight knee), torques say nothing
  /// about the load: statics replace them in that posture.
  double largest_condition = 100.0;
};

/// What the robot felt in one posture, as its sensors report it.
struct Felt {
  Eigen::VectorXd torques;  ///< by joint of the tree, N.m or N; NaN without sensor; empty: none
  int wrench_link = -1;     ///< of a force-torque sensor in the supporting leg; -1: none
  Vector6d wrench = Vector6d::Zero();  ///< see LoadFromWrench
};

/// What loads the elastic parts of the robot in one posture (eq. 5 and 6).
struct PostureLoads {
  JointLoads joints;  ///< empty: nothing is elastic
  /// On the waist, carried by the supporting leg: force [N] and moment [N.m] at the origin of the
  /// root link, in the axes of the foot. Zero without such a leg. As measured: what the sensors'
  /// biases make of it comes on top.
  Vector6d waist = Vector6d::Zero();
  /// Derivative by the torque bias of each joint of the leg, 6 x joints; zero where the load is not
  /// from the leg's torques.
  Eigen::Matrix<double, 6, Eigen::Dynamic> waist_by_bias;
  bool badly_conditioned = false;    ///< statics for want of a bent knee
  std::vector<int> without_torques;  ///< joints of the leg: statics for want of a sensor

  /// The load on the waist with the sensors' biases (geometry.torque_bias) taken off.
  Vector6d WaistLoad(const ErrorModel& model, const Geometry& geometry, int leg) const;
};

/// Loads of the robot that stands as `geometry` says (PlaceWaist), on one leg of the model or, for
/// -1, with the waist held. `gravity_ref` in the reference frame, m/s^2.
PostureLoads LoadPosture(const ErrorModel& model, const Geometry& geometry,
                         const Eigen::VectorXd& q, int leg, const Felt& felt,
                         const Eigen::Vector3d& gravity_ref, const LoadOptions& options);

}  // namespace elastocal
