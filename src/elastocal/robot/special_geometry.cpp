// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/special_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-6;  // m and rad
constexpr double kNearlyParallel = M_PI / 180.0;
constexpr double kNearlyMeeting = 5e-3;  // m

struct AxisLine {
  Vector3d point, direction;
};

AxisLine AxisAtZero(const RobotTree& tree, const std::vector<Transform>& T_root_link, int joint) {
  const Transform& T = T_root_link[tree.joints[joint].child_link];
  return {T.translation(), T.linear() * tree.joints[joint].axis};
}

/// Point of axis `a` closest to axis `b`. The axes must not be parallel.
Vector3d ClosestPoint(const AxisLine& a, const AxisLine& b) {
  const Vector3d across = a.direction.cross(b.direction);
  const double s = (b.point - a.point).cross(b.direction).dot(across) / across.squaredNorm();
  return a.point + s * a.direction;
}

double AngleBetween(const AxisLine& a, const AxisLine& b) {
  return std::atan2(a.direction.cross(b.direction).norm(), std::abs(a.direction.dot(b.direction)));
}

/// Largest distance between the points where neighbouring axes come closest, m.
double WristSpread(const AxisLine& a, const AxisLine& b, const AxisLine& c) {
  const Vector3d points[] = {ClosestPoint(a, b), ClosestPoint(b, a), ClosestPoint(b, c),
                             ClosestPoint(c, b)};
  double spread = 0.0;
  for (const Vector3d& p : points) {
    for (const Vector3d& q : points) spread = std::max(spread, (p - q).norm());
  }
  return spread;
}

/// The previous joint on the way from the root, or -1.
int Previous(const RobotTree& tree, int joint) { return tree.joints[joint].parent_body - 1; }

}  // namespace

double Deviation(const RobotTree& tree, const SpecialGeometry& group) {
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
  const auto axis = [&](int i) { return AxisAtZero(tree, T_root_link, group.joints[i]); };
  if (group.kind == SpecialGeometry::Kind::kParallelAxes) return AngleBetween(axis(0), axis(1));
  return WristSpread(axis(0), axis(1), axis(2));
}

namespace {

/// Groups whose deviation is from `least` on and below `most_angle` or `most_spread`.
std::vector<SpecialGeometry> FindGroups(const RobotTree& tree, double least, double most_angle,
                                        double most_spread) {
  using GroupKind = SpecialGeometry::Kind;
  std::vector<SpecialGeometry> groups;
  const auto revolute = [&](int k) {
    return k >= 0 && tree.joints[k].type == JointType::kRevolute;
  };
  const auto angle = [&](int a, int b) {
    return Deviation(tree, {GroupKind::kParallelAxes, {a, b}});
  };
  for (int c = 0; c < static_cast<int>(tree.joints.size()); ++c) {
    const int b = Previous(tree, c);
    if (!revolute(c) || !revolute(b)) continue;
    const double off = angle(b, c);
    if (off >= least && off < most_angle) groups.push_back({GroupKind::kParallelAxes, {b, c}});
    const int a = Previous(tree, b);
    if (!revolute(a) || off < 0.1 || angle(a, b) < 0.1) continue;
    const SpecialGeometry wrist{GroupKind::kSphericalWrist, {a, b, c}};
    const double spread = Deviation(tree, wrist);
    if (spread >= least && spread < most_spread) groups.push_back(wrist);
  }
  return groups;
}

}  // namespace

std::vector<SpecialGeometry> FindSpecialGeometry(const RobotTree& tree) {
  return FindGroups(tree, 0.0, kExact, kExact);
}

std::vector<SpecialGeometry> FindNearlySpecialGeometry(const RobotTree& tree) {
  return FindGroups(tree, kExact, kNearlyParallel, kNearlyMeeting);
}

double AxisDistance(const RobotTree& tree, int first, int second) {
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
  const AxisLine a = AxisAtZero(tree, T_root_link, first);
  const AxisLine b = AxisAtZero(tree, T_root_link, second);
  return (b.point - a.point).cross(a.direction).norm();
}

}  // namespace elastocal
