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
  bool sides = false;  ///< names tell that the two limbs are on opposite sides
  bool legs = false;   ///< names tell that both are legs
  bool arms = false;   ///< names tell the sides of two limbs, long enough for arms
};

/// The plane in which two limbs look like mirror images (LookAlike), if there is one.
std::optional<SymmetryPlane> PlaneBetween(const RobotTree& tree,
                                          const std::vector<Transform>& T_root_body, const Limb& a,
                                          const Limb& b) {
  constexpr double kApart = 0.02;
  if (a.joints.size() != b.joints.size()) return {};
  int own = 0;  // joints beyond a common trunk
  Eigen::Vector3d between = Eigen::Vector3d::Zero(), middle = between;
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    if (a.joints[i] == b.joints[i]) continue;
    const Eigen::Vector3d here = T_root_body[Size(a.joints[i]) + 1].translation();
    const Eigen::Vector3d there = T_root_body[Size(b.joints[i]) + 1].translation();
    between += here - there;
    middle += 0.5 * (here + there);
    ++own;
  }
  if (own == 0 || between.norm() < kApart * LongestBranch(tree) * own) return {};
  constexpr int kJointsOfAnArm = 5;
  SymmetryPlane plane{between.normalized(), between.normalized().dot(middle) / own};
  plane.sides = SideByNames(tree, a) * SideByNames(tree, b) < 0;
  plane.legs = IsLegByNames(tree, a) && IsLegByNames(tree, b);
  plane.arms = plane.sides && !plane.legs && own >= kJointsOfAnArm;
  if (!LookAlike(tree, T_root_body, a, b, plane.normal, plane.offset)) return {};
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

bool HasLegs(const Limbs& limbs) {
  return std::any_of(limbs.limbs.begin(), limbs.limbs.end(), [](const Limb& l) { return l.leg; });
}

/// Whether some limbs are legs, and all whose names say so.
bool AreLegsAsNamed(const RobotTree& tree, const Limbs& limbs) {
  return HasLegs(limbs) && std::all_of(limbs.limbs.begin(), limbs.limbs.end(), [&](const Limb& l) {
           return l.leg || !IsLegByNames(tree, l);
         });
}

/// Whether mirrored limbs leave no doubt that the root link looks along x, with z up. They do where
/// names say that they are legs, but they are not.
bool IsRootAhead(const RobotTree& tree, const Limbs& limbs) {
  const auto mirrored = [](const Limb& limb) { return limb.mirror >= 0; };
  const auto doubtful = [&](const Limb& limb) {
    return mirrored(limb) && IsLegByNames(tree, limb) &&
           IsLegByNames(tree, limbs.limbs[Size(limb.mirror)]);
  };
  return std::any_of(limbs.limbs.begin(), limbs.limbs.end(), mirrored) &&
         (HasLegs(limbs) || std::none_of(limbs.limbs.begin(), limbs.limbs.end(), doubtful));
}

Transform FrameOf(const SymmetryPlane& plane, const Eigen::Vector3d& up, double ahead) {
  Transform T_root_new = Transform::Identity();
  const Eigen::Vector3d x = ahead * plane.normal.cross(up).normalized();
  T_root_new.linear() << x, up.cross(x), up;
  T_root_new.translation() = plane.offset * plane.normal;
  return T_root_new.inverse();
}

/// The planes of symmetry of any two limbs, first those of which names tell the sides: the pairs of
/// four legs have several planes.
std::vector<SymmetryPlane> PlanesOf(const RobotTree& tree, const std::vector<Limb>& limbs) {
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  std::vector<SymmetryPlane> planes;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    for (std::size_t j = i + 1; j < limbs.size(); ++j) {
      if (const auto plane = PlaneBetween(tree, poses, limbs[i], limbs[j])) {
        planes.push_back(*plane);
      }
    }
  }
  std::stable_partition(planes.begin(), planes.end(),
                        [](const auto& plane) { return plane.sides; });
  return planes;
}

std::string NewLinkName(const RobotTree& tree) {
  std::string name = "looks_ahead";
  const auto taken = [&](const Link& link) { return link.name == name; };
  while (std::any_of(tree.links.begin(), tree.links.end(), taken)) name += "_2";
  return name;
}

}  // namespace

std::optional<RootAttitude> FindRootAttitude(const RobotTree& tree, const RobotShapes& shapes,
                                             const Semantics& semantics) {
  constexpr double kLevel = 0.05;
  const Limbs limbs = FindLimbs(tree, shapes, semantics);
  if (IsRootAhead(tree, limbs)) return {};
  const std::vector<SymmetryPlane> planes = PlanesOf(tree, limbs.limbs);
  const auto is_mirrored = [](const Limb& limb) { return limb.mirror >= 0; };
  const auto mirrored = [&](const Limbs& found) {
    return std::count_if(found.limbs.begin(), found.limbs.end(), is_mirrored);
  };
  // Of the planes that fit, the one in which most limbs are mirrored.
  const auto best = [&](const Eigen::Vector3d& up, const auto& may_be, const auto& fits) {
    std::optional<RootAttitude> chosen;
    std::ptrdiff_t most = 0;
    for (SymmetryPlane plane : planes) {
      if (!may_be(plane) || std::abs(plane.normal.dot(up)) > kLevel) continue;
      plane.normal = (plane.normal - plane.normal.dot(up) * up).normalized();
      Transform T_new_root = FrameOf(plane, up, 1.0);
      const TurnedRobot turned = Turned(tree, shapes, T_new_root);
      const Limbs found = FindLimbs(turned.tree, turned.shapes, semantics);
      if (!fits(found) || mirrored(found) <= most) continue;
      most = mirrored(found);
      if (LooksAhead(turned, found) < 0.0) T_new_root = FrameOf(plane, up, -1.0);
      chosen = RootAttitude{T_new_root, NewLinkName(tree)};
    }
    return chosen;
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const bool level = mirrored(limbs) == 0;  // else only another axis can point up
  if (level) {
    const auto any = [](const SymmetryPlane&) { return true; };
    if (auto attitude = best(z, any, HasLegs)) return attitude;
  }
  const auto of_legs = [](const SymmetryPlane& plane) { return plane.legs; };
  const auto as_named = [&](const Limbs& found) { return AreLegsAsNamed(tree, found); };
  for (const Eigen::Vector3d& up :
       {Eigen::Vector3d(-z), y, Eigen::Vector3d(-y), x, Eigen::Vector3d(-x)}) {
    if (auto attitude = best(up, of_legs, as_named)) return attitude;
  }
  const bool head = std::any_of(limbs.limbs.begin(), limbs.limbs.end(),
                                [&](const Limb& limb) { return IsHeadByNames(tree, limb); });
  if (!level || !head) return {};
  const auto of_arms = [](const SymmetryPlane& plane) { return plane.arms; };
  return best(z, of_arms, [](const Limbs&) { return true; });
}

std::string AddRootLink(const std::string& urdf, const RobotTree& tree,
                        const RootAttitude& attitude) {
  const std::size_t end = urdf.rfind("</robot");
  if (end == std::string::npos) return urdf;
  std::string joint = attitude.link + "_fixed";
  const auto taken = [&](char quote) {
    return urdf.find(quote + joint + quote) != std::string::npos;
  };
  while (taken('"') || taken('\'')) joint += "_2";
  const Eigen::Vector3d p = attitude.T_new_root.translation();
  const Eigen::Vector3d rpy = ToRpy(attitude.T_new_root.linear(), Eigen::Vector3d::Zero());
  return urdf.substr(0, end) +
         fmt::format(
             "  <!-- Added by elastocal init: a root whose x points ahead, and z up. -->\n"
             "  <link name=\"{0}\"/>\n"
             "  <joint name=\"{8}\" type=\"fixed\">\n"
             "    <parent link=\"{0}\"/>\n"
             "    <child link=\"{1}\"/>\n"
             "    <origin xyz=\"{2:.6f} {3:.6f} {4:.6f}\" rpy=\"{5:.9f} {6:.9f} {7:.9f}\"/>\n"
             "  </joint>\n",
             attitude.link, EscapedXml(tree.links[0].name), p.x(), p.y(), p.z(), rpy.x(), rpy.y(),
             rpy.z(), joint) +
         urdf.substr(end);
}

}  // namespace elastocal
