#pragma once

#include <vector>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// A robot at rest in one posture, as the error model has it.
struct StandingPose {
  Transform T_ref_waist;     ///< of the root link
  Eigen::Matrix3Xd markers;  ///< 3 x N_M, in the reference frame, m
  /// By joint of the tree, as the sensors report them (what balances the load, with their biases),
  /// N.m or N; NaN without sensor.
  Eigen::VectorXd torques;
};

/// Leg of the model whose foot is all that a trial stands on; -1: there is none.
int SupportingLeg(const ErrorModel& model, const std::vector<int>& support);

/// The robot on one leg that gives way under its weight (eq. 5 to 7): loads follow from the
/// deflected posture, and this from the loads, until they agree. The foot is at `T_ref_foot`, and
/// what is on it does not move. `q` by coordinate; `gravity_ref` in the reference frame, m/s^2.
StandingPose StandOnLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        int leg, const Transform& T_ref_foot, const Eigen::Vector3d& gravity_ref,
                        const std::vector<int>& torque_sensors);

/// The same with the root link held at `T_ref_waist`: legs hang.
StandingPose HoldWaist(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                       const Transform& T_ref_waist, const Eigen::Vector3d& gravity_ref,
                       const std::vector<int>& torque_sensors);

}  // namespace elastocal
