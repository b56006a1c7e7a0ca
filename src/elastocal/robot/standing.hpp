#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/inverse_dynamics.hpp"

namespace elastocal {

/// The rectangle of a foot that touches the floor, in the plane z = 0 of its link.
struct Sole {
  int link = 0;
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corner of least x and y, m
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();

  Eigen::Vector2d centre() const { return 0.5 * (lower + upper); }
};

/// A convex polygon on the floor, corners counter-clockwise, 2 x corners, m.
using Polygon = Eigen::Matrix2Xd;

/// The smallest convex polygon around points, 2 x points (monotone chain). Points on an edge are no
/// corners.
Polygon ConvexHull(const Eigen::Matrix2Xd& points);

/// Where the robot can stand: the hull of soles at the given poses of their links.
Polygon SupportPolygon(const std::vector<Sole>& soles, const std::vector<Transform>& T_world_sole);

/// How far a point is inside a polygon: distance to the nearest edge's line, m; negative outside.
double InsideMargin(const Polygon& polygon, const Eigen::Vector2d& point);

/// The point of the floor (z = 0 of the world) about which the floor's wrench has no horizontal
/// moment: the zero-moment point. `moment` about the world's origin. The force must press down on
/// the floor (force.z() > 0), else the result is not finite.
Eigen::Vector2d ZeroMomentPoint(const Eigen::Vector3d& force, const Eigen::Vector3d& moment);

/// What one or two soles exert together, by foot. Of two, the first gets the share w of force and
/// vertical moment, w = 1 where the zero-moment point is at its centre and 0 at the other's, in
/// between by the projection on the line of the centres; both press at the same distance from
/// their centres, so that together they press at the zero-moment point. So both forces have the
/// friction ratio of the sum, and the wrenches add up to the given one exactly. What a real pair of
/// legs does depends on its stiffness and on errors of its geometry.
/// Throws std::invalid_argument for no or more than two soles.
std::vector<LinkWrench> ShareWrench(const std::vector<Sole>& soles,
                                    const std::vector<Transform>& T_world_sole,
                                    const Eigen::Vector3d& force, const Eigen::Vector3d& moment);

}  // namespace elastocal
