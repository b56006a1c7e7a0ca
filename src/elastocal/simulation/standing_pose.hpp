// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// A robot at rest in one posture, by the error model.
struct StandingPose {
  Transform T_ref_waist;     ///< of the root link
  Eigen::Matrix3Xd markers;  ///< 3 x N_M, in the reference frame, m
  /// Torques by joint of the tree, as the sensors report them (balancing the load, with biases),
  /// N.m or N; NaN without sensor.
  Eigen::VectorXd torques;
};

/// Leg of the model on whose foot alone a trial stands; -1 if there is none.
int SupportingLeg(const ErrorModel& model, const std::vector<int>& support);

/// The robot on one leg, deflected by its weight (eq. 5 to 7). Loads follow from the deflected
/// posture, and the posture from the loads, until they agree. The foot is at `T_ref_foot`; it and
/// its markers do not move. `q` is by coordinate, `gravity_ref` in the reference frame, m/s^2.
StandingPose StandOnLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        int leg, const Transform& T_ref_foot, const Eigen::Vector3d& gravity_ref,
                        const std::vector<int>& torque_sensors);

/// The robot with its root link held still at `T_ref_waist`, deflected by its weight; the legs
/// hang.
StandingPose HoldWaist(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                       const Transform& T_ref_waist, const Eigen::Vector3d& gravity_ref,
                       const std::vector<int>& torque_sensors);

}  // namespace elastocal
