// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Rotation about the direction of `v` by its length, rad (exponential map of SO(3)).
Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& v);

/// The shortest rotation vector of a rotation matrix; its length is in [0, pi].
Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R);

/// Left Jacobian of SO(3): RotationFromVector(v + dv) = RotationFromVector(L dv)
/// RotationFromVector(v) to first order in dv. The right Jacobian is its transpose.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& v);

/// Inverse of the left Jacobian, for lengths of `v` below 2 pi.
Eigen::Matrix3d InverseLeftJacobian(const Eigen::Vector3d& v);

}  // namespace elastocal
