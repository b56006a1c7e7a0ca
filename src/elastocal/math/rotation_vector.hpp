#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Rotation about the direction of `phi` by its length, rad: the exponential map Exp(phi).
Eigen::Matrix3d RotationExp(const Eigen::Vector3d& phi);

/// Left Jacobian of the exponential map: Exp(phi + e) = Exp(J e) Exp(phi) to first order in e, so
/// that J e is the rotation that e adds, in the axes in which phi is expressed.
Eigen::Matrix3d RotationExpJacobian(const Eigen::Vector3d& phi);

}  // namespace elastocal
