// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Compliance of a leg at the waist.
struct WaistCompliance {
  /// Displacement of the root link's origin and rotation of the root link [m, rad] by a wrench
  /// there [N, N.m], while the encoders keep their positions; both in the axes of the foot.
  Matrix6d C_foot = Matrix6d::Zero();
  /// 1 / C_ii: the stiffness against a load in one direction alone, N/m and N.m/rad.
  Vector6d stiffness = Vector6d::Zero();
};

/// Measures on the true robot what the paper calls K_w (eq. 6). The robot stands on one leg in a
/// posture (by coordinate); known wrenches (20 N, 4 N.m, to either side) push the waist, and its
/// displacement is read. Gravity is off: under its weight a leg gives way more, as an inverted
/// pendulum does, but in eq. 6 the weight's moment is part of the load.
WaistCompliance LumpedWaistCompliance(const TrueRobot& robot, const Leg& leg,
                                      const Eigen::VectorXd& posture, PhysicsOptions options = {});

}  // namespace elastocal
