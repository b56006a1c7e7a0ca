// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/soles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "elastocal/drafting/limb_names.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {
namespace {

// Shares of the leg's length, for a foot of which nothing is known: height of the last joint above
// the sole, and reach of the sole backwards, ahead and to either side.
constexpr double kFootHeight = 0.12, kHeel = 0.10, kToe = 0.17, kHalfWidth = 0.075;

struct FootPoints {
  std::vector<Eigen::Vector3d> root;  ///< points of the shapes in the root link's frame, m
  double floor = std::numeric_limits<double>::infinity();
};

/// A link of the foot's body that lies flat at this height: one that is named as a sole, else the
/// lowest; nothing if there is none.
std::optional<int> FlatLink(const RobotTree& tree, int body, const std::vector<Transform>& T_root,
                            double lowest, double highest) {
  constexpr double kFlat = 0.01;
  std::optional<int> best;
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (tree.links[i].body != body) continue;
    const double height = T_root[i].translation().z();
    const bool flat = (T_root[i].linear().col(2) - Eigen::Vector3d::UnitZ()).norm() < kFlat;
    if (!flat || height < lowest || height > highest) continue;
    if (best) {
      const bool named = NamedSole(tree.links[i].name);
      if (NamedSole(tree.links[Size(*best)].name) != named) {
        if (!named) continue;
      } else if (height >= T_root[Size(*best)].translation().z()) {
        continue;
      }
    }
    best = static_cast<int>(i);
  }
  return best;
}

/// A name that no link has.
std::string NewLinkName(const RobotTree& tree, const std::string& wanted) {
  std::string name = wanted;
  const auto known = [&](const Link& link) { return link.name == name; };
  for (int i = 2; std::any_of(tree.links.begin(), tree.links.end(), known); ++i) {
    name = wanted + "_" + std::to_string(i);
  }
  return name;
}

/// Whether the touching area is large enough for a foot of a leg of this length: at least a quarter
/// of the usual size. A mark at the foot's centre is no foot (EngineAI PM01: a ball of 20 mm).
bool IsFoot(const FootPoints& foot, double thickness, double length) {
  constexpr double kLeastShare = 0.25;
  Eigen::Vector2d least = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d most = -least;
  for (const Eigen::Vector3d& p : foot.root) {
    if (p.z() > foot.floor + thickness) continue;
    least = least.cwiseMin(p.head<2>());
    most = most.cwiseMax(p.head<2>());
  }
  const Eigen::Vector2d usual(kHeel + kToe, 2.0 * kHalfWidth);
  return ((most - least).array() > kLeastShare * length * usual.array()).all();
}

/// Measures the rectangle that touches the floor, in the sole's frame.
void MeasureSole(const FootPoints& foot, const Transform& T_root_sole, double thickness,
                 DraftedSole& sole) {
  sole.lower.setConstant(std::numeric_limits<double>::infinity());
  sole.upper.setConstant(-std::numeric_limits<double>::infinity());
  for (const Eigen::Vector3d& p : foot.root) {
    if (p.z() > foot.floor + thickness) continue;
    const Eigen::Vector2d xy = (T_root_sole.inverse() * p).head<2>();
    sole.lower = sole.lower.cwiseMin(xy);
    sole.upper = sole.upper.cwiseMax(xy);
  }
}

/// A known sole: its height in the root link's frame, and the points that touch the floor.
struct KnownSole {
  double height = 0.0;
  Eigen::Vector2d lower, upper;
};

/// `other` is the sole of the mirrored leg, if only that leg's foot has a shape.
DraftedSole FindSole(const RobotTree& tree, const BodyShape& shape, const Limb& limb,
                     const std::vector<Transform>& T_root_link,
                     const std::optional<KnownSole>& other = {}) {
  constexpr double kThickness = 0.005, kSamePlane = 0.003;
  // Share of the leg's length: frames closer to the ankle belong to rods and sensors (Unitree R1:
  // 0.015), soles are further below (Unitree G1: 0.06).
  constexpr double kLeastFoot = 0.03;
  const Transform& T_root_body = T_root_link[Size(BodyLink(tree, limb.tip_body))];
  const Transform& T_root_hip = T_root_link[Size(tree.joints[Size(limb.joints[0])].child_link)];
  const double ankle = T_root_body.translation().z();
  const double length = (T_root_hip.translation().z() - ankle) * (1.0 + kFootHeight);
  FootPoints foot;
  for (const Eigen::Vector3d& p : shape.points) {
    foot.root.push_back(T_root_body * p);
    foot.floor = std::min(foot.floor, foot.root.back().z());
  }
  const bool guessed = shape.guessed || !IsFoot(foot, kThickness, length);
  DraftedSole sole;
  sole.guessed_size = guessed && !other;
  std::optional<int> link;
  if (other) {
    foot.floor = other->height;
    link = FlatLink(tree, limb.tip_body, T_root_link, foot.floor - kSamePlane,
                    foot.floor + kSamePlane);
  } else if (guessed) {
    link = FlatLink(tree, limb.tip_body, T_root_link, ankle - length, ankle - kLeastFoot * length);
    sole.guessed_height = !link;
    foot.floor = link ? T_root_link[Size(*link)].translation().z() : ankle - kFootHeight * length;
  } else {
    link = FlatLink(tree, limb.tip_body, T_root_link, foot.floor - kSamePlane,
                    foot.floor + kSamePlane);
  }
  Transform T_root_sole = Transform::Identity();
  T_root_sole.translation() << T_root_body.translation().head<2>(), foot.floor;
  sole.added = !link;
  if (link) {
    sole.link = tree.links[Size(*link)].name;
    T_root_sole = T_root_link[Size(*link)];
  } else {
    sole.link = NewLinkName(tree, limb.name + "_sole");
    sole.parent_link = BodyLink(tree, limb.tip_body);
    sole.T_parent_sole = T_root_body.inverse() * T_root_sole;
  }
  sole.lower = {-kHeel * length, -kHalfWidth * length};
  sole.upper = {kToe * length, kHalfWidth * length};
  if (other) {
    sole.lower = {other->lower.x(), -other->upper.y()};
    sole.upper = {other->upper.x(), -other->lower.y()};
  } else if (!guessed) {
    MeasureSole(foot, T_root_sole, kThickness, sole);
  }
  return sole;
}

/// The foot, about the limb's tip, of a leg that can place its foot but not rotate it.
DraftedSole FindBall(const RobotTree& tree, const BodyShape& shape, const Limb& limb,
                     const std::vector<Transform>& T_root_link) {
  // Share of the leg's length: a thicker foot is no ball about the tip.
  constexpr double kThickest = 0.2;
  const Transform& T_root_body = T_root_link[Size(BodyLink(tree, limb.tip_body))];
  const double tip = T_root_link[Size(limb.tip_link)].translation().z();
  const double hip =
      T_root_link[Size(tree.joints[Size(limb.joints[0])].child_link)].translation().z();
  DraftedSole sole;
  sole.link = tree.links[Size(limb.tip_link)].name;
  sole.ball_radius = 0.0;
  sole.guessed_size = true;
  if (shape.guessed) return sole;
  double lowest = tip;
  for (const Eigen::Vector3d& p : shape.points) lowest = std::min(lowest, (T_root_body * p).z());
  if (tip - lowest > kThickest * (hip - tip)) return sole;
  sole.ball_radius = tip - lowest;
  sole.guessed_size = false;
  return sole;
}

}  // namespace

std::vector<DraftedSole> FindSoles(const RobotTree& tree, const RobotShapes& shapes,
                                   const Limbs& limbs) {
  const auto T_root_link = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const auto shape_of = [&](const Limb& limb) -> const BodyShape& {
    return shapes.bodies[Size(limb.tip_body)];
  };
  std::vector<DraftedSole> soles;
  for (std::size_t i = 0; i < limbs.limbs.size(); ++i) {
    const Limb& limb = limbs.limbs[i];
    if (!limb.leg) continue;
    const bool ball = ChainCoordinates(tree, 0, limb.tip_link).size() < LeastLegJoints(false);
    soles.push_back(ball ? FindBall(tree, shape_of(limb), limb, T_root_link)
                         : FindSole(tree, shape_of(limb), limb, T_root_link));
    soles.back().limb = static_cast<int>(i);
  }
  // The foot of one leg may have a shape while that of its mirror image has none.
  for (DraftedSole& sole : soles) {
    const Limb& limb = limbs.limbs[Size(sole.limb)];
    if (!sole.guessed_size || sole.ball_radius || limb.mirror < 0) continue;
    for (const DraftedSole& other : soles) {
      if (other.limb != limb.mirror || other.guessed_size || other.ball_radius) continue;
      const Transform T_root_other =
          other.added ? T_root_link[Size(other.parent_link)] * other.T_parent_sole
                      : T_root_link[Size(FindLink(tree, other.link))];
      const int own = sole.limb;
      sole = FindSole(tree, shape_of(limb), limb, T_root_link,
                      KnownSole{T_root_other.translation().z(), other.lower, other.upper});
      sole.limb = own;
    }
  }
  return soles;
}

std::optional<double> ChooseStance(const RobotTree& tree, const Limbs& limbs,
                                   const std::vector<DraftedSole>& soles) {
  constexpr double kRoom = 0.08;  // gap between the soles, as a share of the leg's height
  if (soles.size() != 2) return {};
  const auto T_root_link = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const auto corners = [&](const DraftedSole& sole) {
    Eigen::Matrix3Xd points(3, 4);
    points << sole.lower.x(), sole.upper.x(), sole.upper.x(), sole.lower.x(),  //
        sole.lower.y(), sole.lower.y(), sole.upper.y(), sole.upper.y(), 0.0, 0.0, 0.0, 0.0;
    return Eigen::Matrix3Xd(T_root_link[Size(FindLink(tree, sole.link))] * points);
  };
  const Eigen::Matrix3Xd a = corners(soles[0]), b = corners(soles[1]);
  Eigen::Vector3d between = b.rowwise().mean() - a.rowwise().mean();
  between.z() = 0.0;
  const double distance = between.norm();
  const Eigen::RowVector3d along = between.transpose() / distance;
  const double gap = (along * b).minCoeff() - (along * a).maxCoeff();
  const double room =
      kRoom * (LegTop(tree, limbs.limbs[Size(soles[0].limb)].joints) - a.row(2).mean());
  if (gap >= room) return {};
  return distance + room - gap;
}

std::string AddSoleLinks(const std::string& urdf, const RobotTree& tree,
                         const std::vector<DraftedSole>& soles) {
  std::string added;
  for (const DraftedSole& sole : soles) {
    if (!sole.added) continue;
    const Eigen::Vector3d p = sole.T_parent_sole.translation();
    const Eigen::Vector3d rpy = ToRpy(sole.T_parent_sole.linear(), Eigen::Vector3d::Zero());
    added += fmt::format(
        "  <!-- Added by elastocal init: the underside of a foot, z up. -->\n"
        "  <link name=\"{0}\"/>\n"
        "  <joint name=\"{0}_fixed\" type=\"fixed\">\n"
        "    <parent link=\"{1}\"/>\n"
        "    <child link=\"{0}\"/>\n"
        "    <origin xyz=\"{2:.6f} {3:.6f} {4:.6f}\" rpy=\"{5:.9f} {6:.9f} {7:.9f}\"/>\n"
        "  </joint>\n",
        sole.link, EscapedXml(tree.links[Size(sole.parent_link)].name), p.x(), p.y(), p.z(),
        rpy.x(), rpy.y(), rpy.z());
  }
  const std::size_t end = urdf.rfind("</robot");
  if (added.empty() || end == std::string::npos) return urdf;
  return urdf.substr(0, end) + added + urdf.substr(end);
}

}  // namespace elastocal
