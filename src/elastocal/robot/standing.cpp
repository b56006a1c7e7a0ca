// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/standing.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "elastocal/math/decompositions.hpp"

namespace elastocal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector2d CentreOnFloor(const Sole& sole, const Transform& T_world_sole) {
  const Vector2d centre = sole.centre();
  return (T_world_sole * Vector3d(centre.x(), centre.y(), 0.0)).head<2>();
}

/// Forces at points (columns) with the least sum of squares that give the force and the moment
/// about the origin, 3 x points.
Eigen::Matrix3Xd LeastForces(const Eigen::Matrix3Xd& points, const Vector3d& force,
                             const Vector3d& moment) {
  Eigen::MatrixXd sum(6, 3 * points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    sum.block<3, 3>(0, 3 * i).setIdentity();
    sum.block<3, 3>(3, 3 * i) = Skew(points.col(i));
  }
  Eigen::VectorXd wanted(6);
  wanted << force, moment;
  return ShortestSolution(sum, wanted).reshaped(3, points.cols());
}

/// Shares a wrench among three or more soles, of which those that would pull carry nothing.
std::vector<LinkWrench> ShareAmongMany(const std::vector<Sole>& soles,
                                       const std::vector<Transform>& T_world_sole,
                                       const Vector3d& force, const Vector3d& moment) {
  std::vector<Eigen::Index> pressing(soles.size());
  std::iota(pressing.begin(), pressing.end(), 0);
  Eigen::Matrix3Xd centres(3, static_cast<Eigen::Index>(soles.size()));
  for (std::size_t i = 0; i < soles.size(); ++i) {
    centres.col(static_cast<Eigen::Index>(i)) << CentreOnFloor(soles[i], T_world_sole[i]), 0.0;
  }
  Eigen::Matrix3Xd forces;
  while (true) {
    forces = LeastForces(centres(Eigen::all, pressing), force, moment);
    Eigen::Index least = 0;
    if (forces.row(2).minCoeff(&least) >= 0.0 || pressing.size() <= 3) break;
    pressing.erase(pressing.begin() + least);
  }
  std::vector<LinkWrench> wrenches;
  for (const Sole& sole : soles)
    wrenches.push_back({sole.link, Vector3d::Zero(), Vector3d::Zero()});
  for (std::size_t i = 0; i < pressing.size(); ++i) {
    const Vector3d pressed = forces.col(static_cast<Eigen::Index>(i));
    LinkWrench& wrench = wrenches[static_cast<std::size_t>(pressing[i])];
    wrench = {wrench.link, pressed, centres.col(pressing[i]).cross(pressed)};
  }
  return wrenches;
}

}  // namespace

std::vector<double> HeightsOverFloor(const Sole& sole, const Transform& T_world_sole) {
  if (sole.ball_radius) return {T_world_sole.translation().z() - *sole.ball_radius};
  std::vector<double> heights;
  for (const double x : {sole.lower.x(), sole.upper.x()}) {
    for (const double y : {sole.lower.y(), sole.upper.y()}) {
      heights.push_back((T_world_sole * Vector3d(x, y, 0.0)).z());
    }
  }
  return heights;
}

Eigen::Matrix3d FloorAxes(const std::vector<Vector3d>& centres) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : centres) middle += p / static_cast<double>(centres.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : centres) spread += (p - middle) * (p - middle).transpose();
  const Vector3d normal = DecomposeSymmetric(spread).vectors.col(0);
  const Vector3d z = normal.z() < 0.0 ? Vector3d(-normal) : normal;
  const Vector3d y = z.cross(Vector3d::UnitX()).normalized();
  Eigen::Matrix3d axes;
  axes << y.cross(z), y, z;
  return axes;
}

Polygon ConvexHull(const Eigen::Matrix2Xd& points) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return points(0, a) != points(0, b) ? points(0, a) < points(0, b) : points(1, a) < points(1, b);
  });
  std::vector<Vector2d> hull;
  const auto add = [&](const Vector2d& point, std::size_t least) {
    while (hull.size() >= least &&
           Cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const Eigen::Index i : order) add(points.col(i), 2);  // below
  const std::size_t below = hull.size() + 1;
  for (auto i = order.rbegin() + 1; i < order.rend(); ++i) add(points.col(*i), below);  // above
  if (hull.size() > 1) hull.pop_back();  // the first again
  Polygon polygon(2, static_cast<Eigen::Index>(hull.size()));
  for (std::size_t i = 0; i < hull.size(); ++i) {
    polygon.col(static_cast<Eigen::Index>(i)) = hull[i];
  }
  return polygon;
}

Polygon SupportPolygon(const std::vector<Sole>& soles, const std::vector<Transform>& T_world_sole) {
  Eigen::Matrix2Xd corners(2, 4 * static_cast<Eigen::Index>(soles.size()));
  for (std::size_t i = 0; i < soles.size(); ++i) {
    const Sole& sole = soles[i];
    const auto column = 4 * static_cast<Eigen::Index>(i);
    const auto corner = [&](double x, double y) -> Vector2d {
      return (T_world_sole[i] * Vector3d(x, y, 0.0)).head<2>();
    };
    corners.col(column) = corner(sole.lower.x(), sole.lower.y());
    corners.col(column + 1) = corner(sole.upper.x(), sole.lower.y());
    corners.col(column + 2) = corner(sole.upper.x(), sole.upper.y());
    corners.col(column + 3) = corner(sole.lower.x(), sole.upper.y());
  }
  return ConvexHull(corners);
}

double InsideMargin(const Polygon& polygon, const Vector2d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < polygon.cols(); ++i) {
    const Vector2d from = polygon.col(i);
    const Vector2d edge = polygon.col((i + 1) % polygon.cols()) - from;
    least = std::min(least, Cross(edge, point - from) / edge.norm());
  }
  return least;
}

Vector2d ZeroMomentPoint(const Vector3d& force, const Vector3d& moment) {
  return Vector2d(-moment.y(), moment.x()) / force.z();
}

std::vector<LinkWrench> ShareWrench(const std::vector<Sole>& soles,
                                    const std::vector<Transform>& T_world_sole,
                                    const Vector3d& force, const Vector3d& moment) {
  if (soles.empty()) throw std::invalid_argument("a wrench can be shared among soles only");
  if (soles.size() == 1) return {{soles[0].link, force, moment}};
  if (soles.size() > 2) return ShareAmongMany(soles, T_world_sole, force, moment);
  const Vector2d zmp = ZeroMomentPoint(force, moment);
  const Vector2d first = CentreOnFloor(soles[0], T_world_sole[0]);
  const Vector2d second = CentreOnFloor(soles[1], T_world_sole[1]);
  const Vector2d line = first - second;
  const double share = std::clamp(line.dot(zmp - second) / line.squaredNorm(), 0.0, 1.0);
  const Vector2d off = zmp - (second + share * line);
  const double turn = moment.z() - Cross(zmp, force.head<2>());  // about the zero-moment point
  const auto wrench = [&](int link, const Vector2d& centre, double part) {
    const Vector3d at(centre.x() + off.x(), centre.y() + off.y(), 0.0);
    return LinkWrench{link, part * force, at.cross(part * force) + Vector3d(0, 0, part * turn)};
  };
  return {wrench(soles[0].link, first, share), wrench(soles[1].link, second, 1.0 - share)};
}

}  // namespace elastocal
