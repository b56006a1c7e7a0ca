// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

namespace elastocal {

/// Rigid transform. `T_a_b` maps coordinates in frame b to coordinates in frame a; metres.
using Transform = Eigen::Isometry3d;

/// Elementary rotations (rad) and translations (m) about and along a frame's own axes.
Transform RotX(double angle);
Transform RotY(double angle);
Transform RotZ(double angle);
Transform TrX(double distance);
Transform TrZ(double distance);

/// Rotation of `angle` about the unit vector `axis`.
Transform RotAxis(const Eigen::Vector3d& axis, double angle);

/// The smallest rotation that turns the direction `from` into the direction `to`; for opposite
/// directions, half a turn about some axis at right angles to them.
Eigen::Matrix3d RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The rigid transform that brings the points `from` (columns, at least three, not on a line)
/// nearest to the points `to`: least squares, no scale (Umeyama 1991).
Transform FitRigid(const Eigen::Ref<const Eigen::Matrix3Xd>& from,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& to);
/// FitRigid for two lists of equally many points; nothing for fewer than three.
std::optional<Transform> FitRigid(const std::vector<Eigen::Vector3d>& from,
                                  const std::vector<Eigen::Vector3d>& to);

/// Whether three or more points (columns, m) tell a pose: they do not lie on a line, within 10 mm.
bool TellPose(const Eigen::Matrix3Xd& points);

/// URDF origin: translation `xyz` [m] and fixed-axis roll, pitch, yaw `rpy` [rad], R = Rz Ry Rx.
Transform FromXyzRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy);

/// Roll, pitch, yaw of a rotation matrix. There are two representations (at pitch = +-90 degrees
/// infinitely many) and their multiples of a turn; the result is the one nearest to `near`,
/// component by component.
Eigen::Vector3d ToRpy(const Eigen::Matrix3d& R, const Eigen::Vector3d& near);

/// Angle of the rotation R, in [0, pi]; exact near zero, where acos of the trace is not.
double RotationAngle(const Eigen::Matrix3d& R);

/// Matrix of the cross product, [v]x w = v x w.
Eigen::Matrix3d Skew(const Eigen::Vector3d& v);

}  // namespace elastocal
