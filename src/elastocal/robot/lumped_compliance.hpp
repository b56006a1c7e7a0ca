// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// Compliance of the waist on a support leg in one posture, with all elasticity of the leg:
/// translation [m] and rotation [rad] of the root link by a small force [N] and moment [N.m] at its
/// origin, in the axes of the foot. It combines the leg's own compliance (eq. 6) and that of its
/// joints (eq. 5), torsion and bending, by the principle of virtual work, while the encoders keep
/// their positions. Symmetric.
Matrix6d LumpedCompliance(const ErrorModel& model, const Geometry& geometry,
                          const Eigen::VectorXd& q, int leg);

}  // namespace elastocal
