// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/rotation_vector.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

constexpr double kSmallAngle = 1e-4;  // series beyond it are exact to 1e-17

}  // namespace

Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  if (angle == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, v / angle).toRotationMatrix();
}

Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  const double sine = q.vec().norm();
  if (sine < 1e-12) return (q.w() < 0.0 ? -2.0 : 2.0) * q.vec();
  const double half = std::atan2(sine, std::abs(q.w()));
  return (q.w() < 0.0 ? -2.0 : 2.0) * half / sine * q.vec();
}

Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const double square = angle * angle;
  const bool small = angle < kSmallAngle;
  const double a = small ? 0.5 - square / 24.0 : (1.0 - std::cos(angle)) / square;
  const double b =
      small ? 1.0 / 6.0 - square / 120.0 : (angle - std::sin(angle)) / (square * angle);
  const Eigen::Matrix3d S = Skew(v);
  return Eigen::Matrix3d::Identity() + a * S + b * S * S;
}

Eigen::Matrix3d InverseLeftJacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  const double square = angle * angle;
  const double b = angle < kSmallAngle ? 1.0 / 12.0 + square / 720.0
                                       : 1.0 / square - 0.5 / (angle * std::tan(0.5 * angle));
  const Eigen::Matrix3d S = Skew(v);
  return Eigen::Matrix3d::Identity() - 0.5 * S + b * S * S;
}

}  // namespace elastocal
