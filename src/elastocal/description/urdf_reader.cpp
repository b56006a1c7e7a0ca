// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/urdf_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "elastocal/description/urdf_outline.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The transform of an origin. Its rotation is computed by a quaternion, so that it is orthonormal
/// up to rounding.
Transform ToTransform(const UrdfOrigin& origin) {
  const Eigen::Vector3d half = 0.5 * origin.rpy;
  const double cr = std::cos(half.x()), cp = std::cos(half.y()), cy = std::cos(half.z());
  const double sr = std::sin(half.x()), sp = std::sin(half.y()), sy = std::sin(half.z());
  const Eigen::Quaterniond rotation(cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy,
                                    cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy);
  return Eigen::Translation3d(origin.xyz) * rotation.normalized();
}

/// Whether moments of inertia are in kg.mm^2 or g.mm^2, as some CAD programs write them: in kg.m^2
/// they would be those of a body of the size of a street.
bool InWrongUnit(const Eigen::Matrix3d& inertia, double mass) {
  constexpr double kLargestRadius_m = 10.0;  // radius of gyration
  constexpr double kNotable = 10.0;          // kg.m^2: smaller ones, of mere frames, do no harm
  const double moment = 0.5 * inertia.trace();
  return moment > kNotable && moment > mass * kLargestRadius_m * kLargestRadius_m;
}

Link ReadLink(const UrdfLink& source, std::vector<std::string>& warnings) {
  constexpr double kRounding = 1e-9;  // kg.m^2: moments hardly below zero are a program's rounding
  Link link;
  link.name = source.name;
  link.T_body_link = Transform::Identity();
  const auto inertial = source.element.Find("inertial");
  if (!inertial) return link;
  const Transform T_link_inertial = ToTransform(ReadUrdfOrigin(*inertial));
  link.mass = inertial->Get("mass").Number("value");
  link.com = T_link_inertial.translation();
  const auto found = inertial->Find("inertia");
  if (!found) return link;  // statics needs only mass and centre of mass
  const XmlElement& entries = *found;
  // Numbers may throw, which Eigen does not stand in the middle of a list.
  const double ixx = entries.Number("ixx"), ixy = entries.Number("ixy"),
               ixz = entries.Number("ixz"), iyy = entries.Number("iyy"),
               iyz = entries.Number("iyz"), izz = entries.Number("izz");
  Eigen::Matrix3d inertia;
  inertia << ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz;
  for (double& moment : inertia.diagonal()) {
    if (moment < 0.0 && moment > -kRounding) moment = 0.0;
  }
  if (InWrongUnit(inertia, link.mass)) {
    warnings.push_back("link " + Quote(link.name) +
                       ": its inertia is that of a body more than 20 m wide, as if it were not in "
                       "kg.m^2; it is taken to have a mass only");
    return link;
  }
  link.inertia = T_link_inertial.linear() * inertia * T_link_inertial.linear().transpose();
  return link;
}

Eigen::Vector3d ReadAxis(const UrdfJoint& joint, std::vector<std::string>& warnings) {
  constexpr double kShortest = 1e-6;  // a shorter axis is rounding noise and no direction
  constexpr double kRounding = 0.1;
  const auto axis = joint.element.FindFirst("axis");
  if (!axis) return Eigen::Vector3d::UnitX();
  const Eigen::Vector3d xyz = axis->Vector("xyz");
  const double length = xyz.stableNorm();
  if (length < kShortest) axis->Fail("the axis is zero; a direction was expected");
  const auto children = joint.element.Children();
  const auto axes = std::count_if(children.begin(), children.end(),
                                  [](const XmlElement& child) { return child.Tag() == "axis"; });
  if (axes > 1) {
    warnings.push_back("joint " + Quote(joint.name) + " has " + std::to_string(axes) +
                       " axes; the first one counts");
  }
  if (std::abs(length - 1.0) > kRounding) {
    warnings.push_back("joint " + Quote(joint.name) + " has an axis of the length " +
                       FormatNumber(std::round(1e3 * length) / 1e3) +
                       "; it is taken as a direction only");
  }
  return xyz.stableNormalized().normalized();
}

/// Removes limits of 0 for velocity and effort: a joint that can move has both, so that 0 stands
/// for a number that was not given.
void DropZeroLimits(const UrdfJoint& joint, JointLimits& limits,
                    std::vector<std::string>& warnings) {
  if (!(limits.lower < limits.upper)) return;
  const auto drop = [&](const char* name, double& limit) {
    if (limit != 0.0) return;
    warnings.push_back("joint " + Quote(joint.name) + ": its " + name +
                       " limit is 0; it is taken to have none");
    limit = kInfinity;
  };
  drop("velocity", limits.velocity);
  drop("effort", limits.effort);
}

JointLimits ReadLimits(const UrdfJoint& joint, std::vector<std::string>& warnings) {
  JointLimits limits = {-kInfinity, kInfinity, kInfinity, kInfinity};
  const bool continuous = joint.type == "continuous";
  if (continuous && !joint.element.Find("limit")) return limits;
  const XmlElement limit = joint.element.Get("limit");
  limits.velocity = limit.Number("velocity");
  limits.effort = limit.Number("effort");
  if (continuous) {
    DropZeroLimits(joint, limits, warnings);
    return limits;
  }
  limits.lower = limit.NumberOr("lower", 0.0);
  limits.upper = limit.NumberOr("upper", 0.0);
  if (limits.lower > limits.upper) {
    warnings.push_back("joint " + Quote(joint.name) + ": lower limit " +
                       FormatNumber(limits.lower) + " is above upper limit " +
                       FormatNumber(limits.upper) + "; they are exchanged");
    std::swap(limits.lower, limits.upper);
  }
  // Limits of wheels and turntables that should be continuous. Nobody counts so many turns.
  constexpr double kEndless = 1e3;
  const bool endless = limits.lower <= -kEndless && limits.upper >= kEndless;
  if (endless && joint.type == "revolute") {
    warnings.push_back("joint " + Quote(joint.name) + ": its limits are " +
                       FormatNumber(limits.lower) + " and " + FormatNumber(limits.upper) +
                       "; it is taken to turn without an end");
    limits.lower = -kInfinity;
    limits.upper = kInfinity;
  } else if (limits.lower < -kEndless || limits.upper > kEndless) {
    limit.Fail("limits of joint " + Quote(joint.name) + " are " + FormatNumber(limits.lower) +
               " and " + FormatNumber(limits.upper) +
               "; from -1000 to 1000 was expected (a joint without limits is continuous)");
  }
  DropZeroLimits(joint, limits, warnings);
  return limits;
}

/// Builds the tree of bodies outwards from the root.
class TreeBuilder {
 public:
  explicit TreeBuilder(const UrdfOutline& outline) : outline_(outline) {}

  RobotTree Build() {
    tree_.name = outline_.robot;
    tree_.warnings = outline_.warnings;
    AddLinks();
    child_joints_.resize(outline_.links.size());
    for (std::size_t j = 0; j < outline_.joints.size(); ++j) {
      if (outline_.joints[j].dropped) continue;
      child_joints_[outline_.joints[j].parent].push_back(static_cast<int>(j));
    }
    tree_joint_.resize(outline_.joints.size(), -1);
    Reach(outline_.root);
    while (!ready_.empty()) {
      const int next = *ready_.begin();
      ready_.erase(ready_.begin());
      AddMovable(next);
    }
    AssignCoordinates();
    return std::move(tree_);
  }

 private:
  /// The root first, the others as in the file.
  void AddLinks() {
    std::vector<int> order = {outline_.root};
    for (int i = 0; i < static_cast<int>(outline_.links.size()); ++i) {
      if (i != outline_.root && !outline_.links[i].dropped) order.push_back(i);
    }
    tree_link_.resize(outline_.links.size(), -1);
    for (int i : order) {
      tree_link_[i] = static_cast<int>(tree_.links.size());
      tree_.links.push_back(ReadLink(outline_.links[i], tree_.warnings));
    }
  }

  Link& TreeLink(int i) { return tree_.links[tree_link_[i]]; }

  /// Links fixed to a reached one are reached with it; movable joints on it become ready.
  void Reach(int first) {
    std::vector<int> reached = {first};
    while (!reached.empty()) {
      const int parent = reached.back();
      reached.pop_back();
      for (int j : child_joints_[parent]) {
        const UrdfJoint& joint = outline_.joints[j];
        if (joint.type != "fixed") {
          ready_.insert(j);
          continue;
        }
        TreeLink(joint.child).body = TreeLink(parent).body;
        TreeLink(joint.child).T_body_link =
            TreeLink(parent).T_body_link * ToTransform(joint.origin);
        reached.push_back(joint.child);
      }
    }
  }

  void AddMovable(int j) {
    const UrdfJoint& source = outline_.joints[j];
    Joint joint;
    joint.name = source.name;
    joint.type = source.type == "prismatic" ? JointType::kPrismatic : JointType::kRevolute;
    joint.parent_link = tree_link_[source.parent];
    joint.child_link = tree_link_[source.child];
    joint.parent_body = TreeLink(source.parent).body;
    joint.T_parent_child = ToTransform(source.origin);
    joint.axis = ReadAxis(source, tree_.warnings);
    joint.limits = ReadLimits(source, tree_.warnings);
    joint.mimic = source.leader >= 0;
    tree_joint_[j] = static_cast<int>(tree_.joints.size());
    tree_.joints.push_back(joint);
    TreeLink(source.child).body = static_cast<int>(tree_.joints.size());
    Reach(source.child);
  }

  void AssignCoordinates() {
    for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
      Joint& joint = tree_.joints[k];
      if (joint.mimic) continue;
      joint.coordinate = tree_.coordinate_count();
      tree_.coordinate_joint.push_back(static_cast<int>(k));
    }
    std::vector<bool> done(outline_.joints.size(), false);
    for (std::size_t j = 0; j < outline_.joints.size(); ++j) {
      std::vector<int> followers;
      if (outline_.joints[j].dropped) continue;
      for (int next = static_cast<int>(j); !done[next]; next = outline_.joints[next].leader) {
        done[next] = true;
        if (outline_.joints[next].leader < 0) break;
        followers.push_back(next);
      }
      std::reverse(followers.begin(), followers.end());
      for (const int follower : followers) Follow(follower);
    }
  }

  /// Position = m (m' q + o') + o, where the leader's is m' q + o'.
  void Follow(int j) {
    const UrdfJoint& source = outline_.joints[j];
    const XmlElement mimic = source.element.Get("mimic");
    const double multiplier = mimic.NumberOr("multiplier", 1.0);
    Joint& joint = tree_.joints[tree_joint_[j]];
    const Joint& leader = tree_.joints[tree_joint_[source.leader]];
    joint.coordinate = leader.coordinate;
    joint.multiplier = leader.multiplier * multiplier;
    joint.offset = multiplier * leader.offset + mimic.NumberOr("offset", 0.0);
    if (!std::isfinite(joint.offset) || !std::isfinite(joint.multiplier)) {
      mimic.Fail("joint " + Quote(joint.name) +
                 " mimics others with a multiplier or offset that is not finite");
    }
    DropWrongMimicLimits(joint);
  }

  /// Drops limits of a mimic joint within which it cannot follow its driver. They are wrong; most
  /// often a sign was forgotten.
  void DropWrongMimicLimits(Joint& joint) {
    const JointLimits& driver = tree_.joints[tree_.coordinate_joint[joint.coordinate]].limits;
    const auto [lower, upper] = std::minmax({joint.multiplier * driver.lower + joint.offset,
                                             joint.multiplier * driver.upper + joint.offset});
    const double common =
        std::min<double>(upper, joint.limits.upper) - std::max<double>(lower, joint.limits.lower);
    if (!std::isfinite(upper - lower) || !(upper > lower)) return;
    if (joint.limits.lower == joint.limits.upper || common > 0.0) return;
    tree_.warnings.push_back("joint " + Quote(joint.name) +
                             " mimics another joint, which moves it " + FormatNumber(lower) +
                             " to " + FormatNumber(upper) +
                             ", outside its own limits; it is taken to have none");
    joint.limits.lower = -kInfinity;
    joint.limits.upper = kInfinity;
  }

  const UrdfOutline& outline_;
  RobotTree tree_;
  std::vector<int> tree_link_, tree_joint_;     ///< in the tree, of those of the outline
  std::vector<std::vector<int>> child_joints_;  ///< of every link, in the order of the file
  std::set<int> ready_;                         ///< movable joints whose parent link is placed
};

}  // namespace

RobotTree ReadUrdf(const std::filesystem::path& file) {
  return ParseUrdf(ReadFile(file), file.string());
}

RobotTree ParseUrdf(const std::string& text, const std::string& source) {
  const XmlText xml(text, source);
  const UrdfOutline outline = ReadUrdfOutline(xml);
  return TreeBuilder(outline).Build();
}

}  // namespace elastocal
