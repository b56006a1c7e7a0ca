// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/inverse_dynamics.hpp"

namespace elastocal {

/// The part of a foot that touches the floor: a rectangle in the plane z = 0 of its link, or a ball
/// about the origin of its link, which touches the floor in one point.
struct Sole {
  int link = 0;
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corner of least x and y, m; 0 of a ball
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();
  std::optional<double> ball_radius = {};  ///< m, 0 or more; none: a flat sole

  Eigen::Vector2d centre() const { return 0.5 * (lower + upper); }
  /// Height of the link's origin over the floor on which the foot stands, m.
  double height() const { return ball_radius.value_or(0.0); }
};

/// Heights over the plane z = 0 of the world, m: of the four corners of a flat sole, or of the
/// lowest point of a ball.
std::vector<double> HeightsOverFloor(const Sole& sole, const Transform& T_world_sole);

/// Axes of the floor (columns) in the root link's frame of a robot that stands on three or more
/// balls with these centres: z is the normal of their plane that points upwards, and x points
/// ahead, as nearly as z allows.
Eigen::Matrix3d FloorAxes(const std::vector<Eigen::Vector3d>& centres);

/// A convex polygon on the floor, corners counter-clockwise, 2 x corners, m.
using Polygon = Eigen::Matrix2Xd;

/// The smallest convex polygon around `points`, 2 x points (monotone chain). Points on an edge do
/// not become corners.
Polygon ConvexHull(const Eigen::Matrix2Xd& points);

/// Support polygon: the convex hull of soles at the given poses of their links.
Polygon SupportPolygon(const std::vector<Sole>& soles, const std::vector<Transform>& T_world_sole);

/// Distance of a point inside a polygon to the line of the nearest edge, m; negative outside.
double InsideMargin(const Polygon& polygon, const Eigen::Vector2d& point);

/// Zero-moment point: the point of the floor (z = 0 of the world) about which the floor's wrench
/// has no horizontal moment. `moment` is about the world's origin. The result is finite only if the
/// robot presses on the floor (force.z() > 0).
Eigen::Vector2d ZeroMomentPoint(const Eigen::Vector3d& force, const Eigen::Vector3d& moment);

/// Shares the floor's wrench among soles; one wrench for each sole. Of a pair, the first gets
/// the share w of force and vertical moment: w = 1 if the zero-moment point is at its centre, 0 at
/// the centre of the other, and in between by the projection on the line of the centres. Both press
/// at the same offset from their centres, so that together they press at the zero-moment point.
/// Both forces then have the friction ratio of the sum, and the wrenches add up to the given one
/// exactly. Three and more press at their centres without a moment, each with the forces whose
/// sum of squares is the least; a foot that would have to pull is left out. The shares of real legs
/// depend on their stiffness and on errors of their geometry. Throws std::invalid_argument without
/// soles.
std::vector<LinkWrench> ShareWrench(const std::vector<Sole>& soles,
                                    const std::vector<Transform>& T_world_sole,
                                    const Eigen::Vector3d& force, const Eigen::Vector3d& moment);

}  // namespace elastocal
