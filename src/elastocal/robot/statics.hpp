#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Standard gravity as most dynamics engines have it, m/s^2; z of the root link up.
inline const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// What a joint carries while `fixed_link` stands still: all that moves with respect to that link
/// when the joint does.
struct CarriedLoad {
  double mass = 0.0;                                 ///< kg
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< mass times centre of mass, kg.m
  /// On the joint's own body and beyond it (1) or, where the joint is between the root link and the
  /// fixed link, on the root's side (-1): the load then turns the parent and not the child.
  int side = 1;
};

/// One a joint, positions in the frame of `T_ref_link` (poses of all links).
std::vector<CarriedLoad> CarriedLoads(const RobotTree& tree,
                                      const std::vector<Transform>& T_ref_link, int fixed_link);

/// Torques (forces for prismatic joints) that the motors must supply to hold the robot still while
/// `fixed_link` (index of a link) is fixed to the floor and nothing else touches the robot, by
/// coordinate of q; N.m or N. `gravity_waist` is the acceleration of gravity in the root link's
/// frame. The load that bends the joints is the opposite.
Eigen::VectorXd StaticTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                              const Eigen::Vector3d& gravity_waist, int fixed_link);

/// The same with the root link held.
Eigen::VectorXd GravityTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                               const Eigen::Vector3d& gravity_waist = kGravity);

/// Loads of the calibrated robot under gravity (acceleration in the reference frame, m/s^2) while
/// `fixed_link` stands still: a foot, or the root link (0). Masses are the URDF's, poses those of
/// `geometry`, deflected by `deflected_by` (for a second step: loads of the robot as it hangs).
/// Joints without parameters carry but do not bend: their columns are zero.
///
/// The moment is that which turns the child against the parent. Of a joint between the root link
/// and the fixed link it is the opposite of the moment of the carried side, which is the parent's:
/// the joint's elastic rotation is compliance .* moment in both cases, and m_z = -(motor torque).
JointLoads GravityLoads(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        const Eigen::Vector3d& gravity_ref, int fixed_link,
                        const JointLoads& deflected_by = {});

/// Where a torque [by joint, N.m or N, as the sensors report it: what balances the load] is not
/// NaN, its opposite replaces the load about (along) the joint's axis (eq. 5).
void UseMeasuredTorques(const Eigen::VectorXd& torques, JointLoads& loads);

/// Mass of all links, kg.
double TotalMass(const RobotTree& tree);

}  // namespace elastocal
