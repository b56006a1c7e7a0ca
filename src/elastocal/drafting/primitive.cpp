// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/primitive.hpp"

#include <cmath>
#include <numbers>

#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using std::numbers::pi;

constexpr int kAlongEdge = 7, kAround = 16;

/// The points of a grid over a box that are on its surface.
Points BoxPoints(const Eigen::Vector3d& half) {
  Points points;
  const auto at = [](int i) { return 2.0 * i / (kAlongEdge - 1) - 1.0; };
  const auto edge = [](int i) { return i == 0 || i == kAlongEdge - 1; };
  for (int i = 0; i < kAlongEdge; ++i) {
    for (int j = 0; j < kAlongEdge; ++j) {
      for (int k = 0; k < kAlongEdge; ++k) {
        if (!edge(i) && !edge(j) && !edge(k)) continue;
        points.push_back(half.cwiseProduct(Eigen::Vector3d(at(i), at(j), at(k))));
      }
    }
  }
  return points;
}

Points CylinderPoints(double radius, double half_length) {
  Points points;
  const auto ring = [&](double r, double z) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * pi * i / kAround;
      points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  };
  for (int i = 0; i < kAlongEdge; ++i) {
    ring(radius, half_length * (2.0 * i / (kAlongEdge - 1) - 1.0));
  }
  for (const double z : {-half_length, half_length}) {
    ring(0.5 * radius, z);
    points.emplace_back(0.0, 0.0, z);
  }
  return points;
}

Points SpherePoints(double radius) {
  Points points;
  for (int i = 1; i < kAlongEdge; ++i) {
    const double polar = pi * i / kAlongEdge;
    for (int j = 0; j < kAround; ++j) {
      const double angle = 2.0 * pi * j / kAround;
      points.emplace_back(radius * std::sin(polar) * std::cos(angle),
                          radius * std::sin(polar) * std::sin(angle), radius * std::cos(polar));
    }
  }
  points.emplace_back(0.0, 0.0, radius);
  points.emplace_back(0.0, 0.0, -radius);
  return points;
}

}  // namespace

double Primitive::Volume() const {
  switch (kind) {
    case Kind::kBox:
      return 8.0 * half.prod();
    case Kind::kCylinder:
      return 2.0 * pi * half.prod();
    case Kind::kSphere:
      break;
  }
  return 4.0 / 3.0 * pi * half.prod();
}

bool Primitive::Contains(const Eigen::Vector3d& point, double depth) const {
  const Eigen::Vector3d p = T_body_shape.inverse() * point;
  switch (kind) {
    case Kind::kBox:
      return (p.cwiseAbs().array() < half.array() - depth).all();
    case Kind::kCylinder:
      return p.head<2>().norm() < half.x() - depth && std::abs(p.z()) < half.z() - depth;
    case Kind::kSphere:
      break;
  }
  return p.norm() < half.x() - depth;
}

Points SurfacePoints(const Primitive& shape) {
  Points points = shape.kind == Primitive::Kind::kBox ? BoxPoints(shape.half)
                  : shape.kind == Primitive::Kind::kCylinder
                      ? CylinderPoints(shape.half.x(), shape.half.z())
                      : SpherePoints(shape.half.x());
  for (Eigen::Vector3d& point : points) point = shape.T_body_shape * point;
  return points;
}

Points RodPoints(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius) {
  const Eigen::Vector3d along = to - from;
  const auto turn = RotationBetween(
      Eigen::Vector3d::UnitZ(), along.norm() > 0.0 ? along.normalized() : Eigen::Vector3d::UnitZ());
  Points points;
  for (const Eigen::Vector3d& p : CylinderPoints(radius, 0.5 * along.norm())) {
    if (p.head<2>().norm() > 0.75 * radius) points.push_back(0.5 * (from + to) + turn * p);
  }
  for (const Eigen::Vector3d& p : SpherePoints(radius)) {
    points.push_back((p.z() < 0.0 ? from : to) + turn * p);
  }
  return points;
}

}  // namespace elastocal
