// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/quantity.hpp"

#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d QuantityValue::Rotation(int first) const {
  return RotationFromVector(x.segment<3>(first)) * origin.linear();
}

Transform QuantityValue::Pose() const {
  Transform pose = Transform::Identity();
  pose.linear() = Rotation(3);
  pose.translation() = origin.translation() + x.head<3>();
  return pose;
}

Matrix3d QuantityValue::Turns(int first) const { return LeftJacobian(x.segment<3>(first)); }

Vector3d QuantityValue::Normal() const {
  return origin.linear() * (RotX(x[1]) * RotY(x[2])).linear().col(2);
}

Eigen::Matrix<double, 3, 2> QuantityValue::NormalTurns() const {
  Eigen::Matrix<double, 3, 2> turns;
  turns.col(0) = Vector3d::UnitX();
  turns.col(1) = RotX(x[1]).linear().col(1);
  return origin.linear() * turns;
}

double QuantityValue::HeightOver(const Vector3d& p) const {
  return Normal().dot(p - origin.translation()) - x[0];
}

Eigen::RowVector3d QuantityValue::HeightByPlane(const Vector3d& p) const {
  const Vector3d n = Normal();
  const auto turns = NormalTurns();
  const Vector3d arm = p - origin.translation();
  return {-1.0, turns.col(0).cross(n).dot(arm), turns.col(1).cross(n).dot(arm)};
}

}  // namespace elastocal
