#pragma once

#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// How the waist gives way on a standing leg in one posture, all of its elasticity together: motion
/// of the root link's origin [m] and rotation [rad] by a small force [N] and moment [N.m] there, in
/// the axes of the foot. The leg's own compliance (eq. 6) and that of its joints (eq. 5), torsion
/// and bending, by the principle of virtual work; encoders stay where they are. Symmetric.
Matrix6d LumpedCompliance(const ErrorModel& model, const Geometry& geometry,
                          const Eigen::VectorXd& q, int leg);

}  // namespace elastocal
