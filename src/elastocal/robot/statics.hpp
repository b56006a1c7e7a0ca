// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Gravity as most dynamics engines have it, m/s^2, with z of the root link up.
inline const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// What a joint carries while a link stands still: everything that moves with respect to that link
/// when the joint does.
struct CarriedLoad {
  double mass = 0.0;                                 ///< kg
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< mass times centre of mass, kg.m
  /// 1 if the joint carries its own body and what is beyond it. -1 if the joint is between the root
  /// link and the fixed link and carries the root's side: the load then turns the parent and not
  /// the child.
  int side = 1;
};

/// Load of each joint. Positions are in the frame ref of `T_ref_link` (poses of all links).
std::vector<CarriedLoad> CarriedLoads(const RobotTree& tree,
                                      const std::vector<Transform>& T_ref_link, int fixed_link);

/// Largest torque (force) of gravity on each joint, N.m or N: the weight of all that it carries,
/// times the distance of the centre of mass from the joint's origin in the zero posture, as if it
/// were held out horizontally. For a prismatic joint, the weight.
Eigen::VectorXd LargestGravityTorques(const RobotTree& tree);

/// Torques (forces for prismatic joints) by coordinate of q that the motors must supply to hold the
/// robot still, N.m or N, while `fixed_link` (index of a link) is fixed to the floor and nothing
/// else touches the robot. `gravity_waist` is the acceleration of gravity in the root link's frame.
/// The load that deflects the joints is the opposite.
Eigen::VectorXd StaticTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                              const Eigen::Vector3d& gravity_waist, int fixed_link);

/// StaticTorques while the root link is held still.
Eigen::VectorXd GravityTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                               const Eigen::Vector3d& gravity_waist = kGravity);

/// Loads of the calibrated robot under gravity (acceleration in the reference frame, m/s^2) while
/// `fixed_link` stands still: a foot, or the root link (0). Masses are those of the URDF, and poses
/// those of `geometry`, deflected by the loads `deflected_by` (in a second step, the loads of the
/// first one). Joints without parameters are rigid: their columns are zero.
///
/// The moment is the one that turns the child against the parent. A joint between the root link and
/// the fixed link carries its parent's side, and the moment is then the opposite of that side's. So
/// the joint's elastic rotation is compliance .* moment, and m_z = -(motor torque), in both cases.
JointLoads GravityLoads(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        const Eigen::Vector3d& gravity_ref, int fixed_link,
                        const JointLoads& deflected_by = {});

/// Derivatives of GravityLoads, with the root link (0) standing still, by each correction of loads
/// that is a parameter of the model: masses and first moments of bodies, and the tilt of gravity to
/// first order. One entry for each correction of the model's elasticity, of no size for others; no
/// entries at all if there are none.
std::vector<Eigen::Matrix3Xd> LoadsByCorrections(const ErrorModel& model, const Geometry& geometry,
                                                 const Eigen::VectorXd& q,
                                                 const Eigen::Vector3d& gravity_ref);

/// Replaces the load about (along) a joint's axis by the opposite of its measured torque, unless
/// that is NaN (eq. 5). `torques`: by joint, N.m or N, as the sensors report them, which balance
/// the load.
void UseMeasuredTorques(const Eigen::VectorXd& torques, JointLoads& loads);

/// Mass of all links, kg.
double TotalMass(const RobotTree& tree);

}  // namespace elastocal
