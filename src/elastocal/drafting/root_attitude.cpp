// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/root_attitude.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "elastocal/drafting/limb_names.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// A plane: normal . p = offset in the root link's frame.
struct SymmetryPlane {
  Eigen::Vector3d normal;
  double offset = 0.0;
};

/// The plane in which the joints of two limbs are mirror images, if they are within 2 % of the
/// longest limb, as PairMirrors requires of the x-z plane.
std::optional<SymmetryPlane> PlaneBetween(const RobotTree& tree,
                                          const std::vector<Transform>& T_root_body, const Limb& a,
                                          const Limb& b) {
  constexpr double kSamePlace = 0.02, kApart = 0.02;
  if (a.from_body != b.from_body || a.joints.size() != b.joints.size()) return {};
  const double longest = LongestBranch(tree);
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> places;
  Eigen::Vector3d between = Eigen::Vector3d::Zero(), middle = between;
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    const int here = a.joints[i], there = b.joints[i];
    if (here == there) continue;  // of the trunk
    if (tree.joints[Size(here)].type != tree.joints[Size(there)].type) return {};
    places.emplace_back(T_root_body[Size(here) + 1].translation(),
                        T_root_body[Size(there) + 1].translation());
    between += places.back().first - places.back().second;
    middle += 0.5 * (places.back().first + places.back().second);
  }
  const auto count = static_cast<double>(places.size());
  if (places.empty() || between.norm() < kApart * longest * count) return {};
  const SymmetryPlane plane{between.normalized(), between.normalized().dot(middle) / count};
  for (const auto& [here, there] : places) {
    const Eigen::Vector3d image =
        here - 2.0 * (plane.normal.dot(here) - plane.offset) * plane.normal;
    if ((there - image).norm() > kSamePlace * longest) return {};
  }
  return plane;
}

/// The tree and the shapes as seen from another frame of the root.
struct TurnedRobot {
  RobotTree tree;
  RobotShapes shapes;
};

TurnedRobot Turned(const RobotTree& tree, const RobotShapes& shapes, const Transform& T_new_root) {
  TurnedRobot turned{tree, shapes};
  for (Eigen::Vector3d& p : turned.shapes.bodies[0].points) p = T_new_root * p;
  for (Link& link : turned.tree.links) {
    if (link.body == 0) link.T_body_link = T_new_root * link.T_body_link;
  }
  return turned;
}

/// By how much the leg's foot goes back, m, as its knee bends half of its range: the joint with the
/// most one-sided range.
double GoesBack(const RobotTree& tree, const Limb& leg) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  const double straight = BodyPoses(tree, q)[Size(leg.tip_body)].translation().x();
  double most = 0.0;
  for (const int k : leg.joints) {
    const Joint& joint = tree.joints[Size(k)];
    const double middle = 0.5 * (joint.limits.lower + joint.limits.upper);
    if (joint.mimic || joint.type != JointType::kRevolute || !(std::abs(middle) > most)) continue;
    most = std::abs(middle);
    q.setZero();
    q[joint.coordinate] = middle;
  }
  return straight - BodyPoses(tree, q)[Size(leg.tip_body)].translation().x();
}

/// Above zero where names call left what is on the left or else, where feet are ahead of their
/// ankles or else, where knees bend the legs back; below zero the other way round.
double LooksAhead(const TurnedRobot& robot, const Limbs& limbs) {
  constexpr double kNotable = 0.01;  // of the longest limb: feet may reach as far back as ahead
  const auto poses = BodyPoses(robot.tree, Eigen::VectorXd::Zero(robot.tree.coordinate_count()));
  double names = 0.0, feet = 0.0, knees = 0.0;
  for (const Limb& limb : limbs.limbs) {
    if (limb.mirror < 0) continue;
    const Transform& tip = poses[Size(limb.tip_body)];
    names += SideByNames(robot.tree, limb) * (tip.translation().y() > 0.0 ? 1.0 : -1.0);
    if (!limb.leg) continue;
    knees += GoesBack(robot.tree, limb);
    const BodyShape& shape = robot.shapes.bodies[Size(limb.tip_body)];
    if (shape.guessed) continue;
    double back = 0.0, ahead = 0.0;  // of the ankle
    for (const Eigen::Vector3d& p : shape.points) {
      const double x = (tip * p).x() - tip.translation().x();
      back = std::min(back, x);
      ahead = std::max(ahead, x);
    }
    feet += back + ahead;
  }
  if (names != 0.0) return names;
  return std::abs(feet) > kNotable * LongestBranch(robot.tree) ? feet : knees;
}

/// Whether mirrored limbs are legs or, as second best, arms.
bool HasMirrored(const Limbs& limbs, bool legs) {
  constexpr std::size_t kJointsOfAnArm = 5;
  return std::any_of(limbs.limbs.begin(), limbs.limbs.end(), [&](const Limb& limb) {
    return limb.mirror >= 0 && (legs ? limb.leg : limb.joints.size() >= kJointsOfAnArm);
  });
}

Transform FrameOf(const SymmetryPlane& plane, const Eigen::Vector3d& up, double ahead) {
  Transform T_root_new = Transform::Identity();
  const Eigen::Vector3d x = ahead * plane.normal.cross(up).normalized();
  T_root_new.linear() << x, up.cross(x), up;
  T_root_new.translation() = plane.offset * plane.normal;
  return T_root_new.inverse();
}

}  // namespace

std::optional<RootAttitude> FindRootAttitude(const RobotTree& tree, const RobotShapes& shapes,
                                             const Semantics& semantics) {
  constexpr double kLevel = 0.05;
  const Limbs limbs = FindLimbs(tree, shapes, semantics);
  const auto mirrored = [](const Limb& limb) { return limb.mirror >= 0; };
  if (std::any_of(limbs.limbs.begin(), limbs.limbs.end(), mirrored)) return {};
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  std::vector<SymmetryPlane> planes;
  for (std::size_t i = 0; i < limbs.limbs.size(); ++i) {
    for (std::size_t j = i + 1; j < limbs.limbs.size(); ++j) {
      if (const auto plane = PlaneBetween(tree, poses, limbs.limbs[i], limbs.limbs[j])) {
        planes.push_back(*plane);
      }
    }
  }
  const auto looks = [&](SymmetryPlane plane, const Eigen::Vector3d& up,
                         bool legs) -> std::optional<RootAttitude> {
    if (std::abs(plane.normal.dot(up)) > kLevel) return {};
    plane.normal = (plane.normal - plane.normal.dot(up) * up).normalized();
    RootAttitude attitude{FrameOf(plane, up, 1.0), "looks_ahead"};
    const TurnedRobot turned = Turned(tree, shapes, attitude.T_new_root);
    const Limbs found = FindLimbs(turned.tree, turned.shapes, semantics);
    if (!HasMirrored(found, legs)) return {};
    if (LooksAhead(turned, found) < 0.0) attitude.T_new_root = FrameOf(plane, up, -1.0);
    const auto taken = [&](const Link& link) { return link.name == attitude.link; };
    while (std::any_of(tree.links.begin(), tree.links.end(), taken)) attitude.link += "_2";
    return attitude;
  };
  // Legs hang below the root link, whatever its axes; of arms nothing tells what is up.
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (const int axis : {2, 1, 0}) {
    for (const double sign : {1.0, -1.0}) {
      for (const SymmetryPlane& plane : planes) {
        if (auto attitude = looks(plane, sign * axes.col(axis), true)) return attitude;
      }
    }
  }
  for (const SymmetryPlane& plane : planes) {
    if (auto attitude = looks(plane, axes.col(2), false)) return attitude;
  }
  return {};
}

std::string AddRootLink(const std::string& urdf, const RobotTree& tree,
                        const RootAttitude& attitude) {
  const std::size_t end = urdf.rfind("</robot");
  if (end == std::string::npos) return urdf;
  const Eigen::Vector3d p = attitude.T_new_root.translation();
  const Eigen::Vector3d rpy = ToRpy(attitude.T_new_root.linear(), Eigen::Vector3d::Zero());
  return urdf.substr(0, end) +
         fmt::format(
             "  <!-- Added by elastocal init: a root whose x points ahead, and z up. -->\n"
             "  <link name=\"{0}\"/>\n"
             "  <joint name=\"{0}_fixed\" type=\"fixed\">\n"
             "    <parent link=\"{0}\"/>\n"
             "    <child link=\"{1}\"/>\n"
             "    <origin xyz=\"{2:.6f} {3:.6f} {4:.6f}\" rpy=\"{5:.9f} {6:.9f} {7:.9f}\"/>\n"
             "  </joint>\n",
             attitude.link, EscapedXml(tree.links[0].name), p.x(), p.y(), p.z(), rpy.x(), rpy.y(),
             rpy.z()) +
         urdf.substr(end);
}

}  // namespace elastocal
