#pragma once

#include <Eigen/Core>

#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Compliance of a leg as it is felt at the waist.
struct BaseCompliance {
  /// Displacement of the root link's origin and rotation of the root link [m, rad] by a wrench
  /// there [N, N.m], encoders held; both in the axes of the foot.
  Matrix6d C_foot = Matrix6d::Zero();
  /// 1 / C_ii: the stiffness felt by a load in one direction alone; N/m and N.m/rad.
  Vector6d stiffness = Vector6d::Zero();
};

/// The truth's own counterpart of the paper's K_w (eq. 6): stands the robot on one leg in a posture
/// (by coordinate), loaded by its weight, pushes the waist by known wrenches to either side (20 N,
/// 4 N.m) and reads how far it gives way.
BaseCompliance LumpedBaseCompliance(const TrueRobot& robot, const Leg& leg,
                                    const Eigen::VectorXd& posture, PhysicsOptions options = {});

}  // namespace elastocal
