// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/transform.hpp"

#include <cmath>

#include "elastocal/math/decompositions.hpp"

namespace elastocal {
namespace {

constexpr double kOpposite = 1e-8;  // length of the sum of directions that have no one axis

}  // namespace

Transform RotX(double angle) { return RotAxis(Eigen::Vector3d::UnitX(), angle); }
Transform RotY(double angle) { return RotAxis(Eigen::Vector3d::UnitY(), angle); }
Transform RotZ(double angle) { return RotAxis(Eigen::Vector3d::UnitZ(), angle); }

Transform TrX(double distance) { return Transform(Eigen::Translation3d(distance, 0.0, 0.0)); }

Transform TrZ(double distance) { return Transform(Eigen::Translation3d(0.0, 0.0, distance)); }

Transform RotAxis(const Eigen::Vector3d& axis, double angle) {
  Transform T = Transform::Identity();
  T.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return T;
}

// Eigen's FromTwoVectors has a singular value decomposition for opposite directions, which takes as
// long to compile as the rest of this file.
Eigen::Matrix3d RotationBetween(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  if (!((a + b).norm() > kOpposite)) {
    return Eigen::AngleAxisd(M_PI, a.unitOrthogonal()).toRotationMatrix();
  }
  const Eigen::Vector3d half = (a + b).normalized();  // the way from a to it, twice
  const Eigen::Vector3d vector = a.cross(half);
  return Eigen::Quaterniond(a.dot(half), vector.x(), vector.y(), vector.z()).toRotationMatrix();
}

bool TellPose(const Eigen::Matrix3Xd& points) {
  constexpr double kLeastWidth = 10e-3;
  if (points.cols() < 3) return false;
  return SingularValues(points.colwise() - points.rowwise().mean())[1] > kLeastWidth;
}

Transform FitRigid(const Eigen::Ref<const Eigen::Matrix3Xd>& from,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& to) {
  return Transform(Eigen::umeyama(from, to, false));
}

std::optional<Transform> FitRigid(const std::vector<Eigen::Vector3d>& from,
                                  const std::vector<Eigen::Vector3d>& to) {
  if (from.size() < 3) return std::nullopt;
  using Points = Eigen::Map<const Eigen::Matrix3Xd>;
  const auto count = static_cast<Eigen::Index>(from.size());
  return FitRigid(Points(from[0].data(), 3, count), Points(to[0].data(), 3, count));
}

Transform FromXyzRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy) {
  Transform T = RotZ(rpy.z()) * RotY(rpy.y()) * RotX(rpy.x());
  T.translation() = xyz;
  return T;
}

namespace {

double NearestTurn(double angle, double near) {
  return angle + 2.0 * M_PI * std::round((near - angle) / (2.0 * M_PI));
}

Eigen::Vector3d NearestTurns(const Eigen::Vector3d& rpy, const Eigen::Vector3d& near) {
  return {NearestTurn(rpy.x(), near.x()), NearestTurn(rpy.y(), near.y()),
          NearestTurn(rpy.z(), near.z())};
}

}  // namespace

Eigen::Vector3d ToRpy(const Eigen::Matrix3d& R, const Eigen::Vector3d& near) {
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  // At pitch = +-90 degrees any roll will do, because yaw then takes the rest; within the limit
  // used here this holds to 2e-12 rad. Outside the limit, roll is exact to 1e-4 rad, and yaw
  // compensates its error.
  const double roll = cos_pitch < 1e-12 ? near.x() : std::atan2(R(2, 1), R(2, 2));
  const Eigen::Matrix3d R_yaw = R * (RotY(pitch) * RotX(roll)).linear().transpose();
  const double yaw = std::atan2(R_yaw(1, 0), R_yaw(0, 0));
  const Eigen::Vector3d first = NearestTurns({roll, pitch, yaw}, near);
  const Eigen::Vector3d second = NearestTurns({roll + M_PI, M_PI - pitch, yaw + M_PI}, near);
  return (first - near).norm() <= (second - near).norm() ? first : second;
}

double RotationAngle(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d twice_sine_axis(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(0.5 * twice_sine_axis.norm(), 0.5 * (R.trace() - 1.0));
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

}  // namespace elastocal
