// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"

namespace elastocal {

/// A box, cylinder or sphere.
struct Primitive {
  enum class Kind { kBox, kCylinder, kSphere };
  Kind kind = Kind::kBox;
  Transform T_body_shape = Transform::Identity();  ///< pose of its centre; a cylinder lies along z
  /// Half of its sides, m. A cylinder has its radius in x and y, a sphere in all three.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();

  double Volume() const;
  /// Whether a point of the body's frame is inside, by more than `depth` [m].
  bool Contains(const Eigen::Vector3d& point, double depth) const;
};

/// Points all over the surface, corners and ends included, in the body's frame, m.
std::vector<Eigen::Vector3d> SurfacePoints(const Primitive& shape);

/// Points all over the surface of a rod with round ends between two points.
std::vector<Eigen::Vector3d> RodPoints(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                       double radius);

}  // namespace elastocal
