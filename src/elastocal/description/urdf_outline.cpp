// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/urdf_outline.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

const std::array<std::string, 6> kJointTypes = {"revolute", "continuous", "prismatic",
                                                "fixed",    "floating",   "planar"};

constexpr int kMostMovable = 300;  // a humanoid with two hands has about 80

std::string UniqueName(const XmlElement& element, std::map<std::string, int>& index) {
  constexpr std::size_t kMost = 5000;  // no robot has more
  constexpr std::size_t kMostAttributes = 100;
  constexpr std::size_t kLongestName = 200;  // bytes; names come in every message and table
  if (element.AttributeCount() > kMostAttributes) {
    element.Fail("more than " + std::to_string(kMostAttributes) + " attributes");
  }
  const std::string name = element.Text("name");
  if (name.size() > kLongestName) {
    element.Fail("the name " + Quote(name) + " has more than " + std::to_string(kLongestName) +
                 " bytes");
  }
  const std::string what(element.Tag());
  if (!index.emplace(name, static_cast<int>(index.size())).second) {
    element.Fail("second " + what + " of the name " + Quote(name));
  }
  if (index.size() > kMost) element.Fail("more than " + std::to_string(kMost) + " " + what + "s");
  return name;
}

/// The link or joint that an attribute of joint `joint` names.
int Named(const XmlElement& element, const char* attribute, const std::string& joint,
          const std::string& relation, const std::map<std::string, int>& index) {
  const std::string name = element.Text(attribute);
  const auto found = index.find(name);
  if (found != index.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [other, unused] : index) known.push_back(other);
  element.Fail("joint " + Quote(joint) + ": " + relation + " " + Quote(name) +
               " is not in the file" + DidYouMean(name.substr(0, 60), known));
}

void ReadEntries(const XmlElement& robot, UrdfOutline& outline) {
  outline.robot = robot.Text("name");
  for (const XmlElement& element : robot.Children()) {
    if (element.Tag() == "link") {
      outline.links.push_back({UniqueName(element, outline.link_index), element});
    } else if (element.Tag() == "joint") {
      const std::string name = UniqueName(element, outline.joint_index);
      outline.joints.push_back({name, element.Text("type"), ReadUrdfOrigin(element), element});
    } else if (element.Tag().starts_with("xacro:")) {
      element.Fail("found <" + std::string(element.Tag()) +
                   ">: this is a xacro file; expand it to a URDF first");
    }
  }
  if (outline.links.empty()) robot.Fail("the robot has no <link>");
  const auto moves = [](const UrdfJoint& joint) { return joint.type != "fixed"; };
  const auto movable = std::count_if(outline.joints.begin(), outline.joints.end(), moves);
  if (movable > kMostMovable) {
    robot.Fail("found " + std::to_string(movable) + " movable joints; at most " +
               std::to_string(kMostMovable) + " are calibrated");
  }
}

void ConnectJoint(int j, UrdfOutline& outline) {
  UrdfJoint& joint = outline.joints[j];
  if (std::find(kJointTypes.begin(), kJointTypes.end(), joint.type) == kJointTypes.end()) {
    joint.element.Fail("joint " + Quote(joint.name) + " is of the unknown type " +
                       Quote(joint.type) + DidYouMean(joint.type.substr(0, 60), kJointTypes));
  }
  const auto link = [&](const char* which) {
    return Named(joint.element.Get(which), "link", joint.name, std::string(which) + " link",
                 outline.link_index);
  };
  joint.parent = link("parent");
  joint.child = link("child");
  UrdfLink& child = outline.links[joint.child];
  if (child.parent_joint >= 0) {
    joint.element.Fail("link " + Quote(child.name) + " is the child of joint " + Quote(joint.name) +
                       " and of joint " + Quote(outline.joints[child.parent_joint].name) +
                       "; a link has one parent");
  }
  child.parent_joint = j;
  const auto mimic = joint.element.Find("mimic");
  if (!mimic || joint.type == "fixed" || joint.type == "floating" || joint.type == "planar") return;
  joint.leader =
      Named(*mimic, "joint", joint.name, "the joint that it mimics,", outline.joint_index);
}

/// Finds the only link without a parent. With one parent each, links that do not hang on it form a
/// loop.
void FindRoot(UrdfOutline& outline) {
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const UrdfLink& link = outline.links[i];
    if (link.parent_joint >= 0) continue;
    if (outline.root >= 0) {
      link.element.Fail("links " + Quote(outline.links[outline.root].name) + " and " +
                        Quote(link.name) + " both have no parent; a robot has one root");
    }
    outline.root = static_cast<int>(i);
  }
  std::vector<bool> on_tree(outline.links.size(), false);
  for (std::size_t start = 0; start < outline.links.size(); ++start) {
    std::vector<int> path;
    int link = static_cast<int>(start);
    while (!on_tree[link] && outline.links[link].parent_joint >= 0) {
      if (path.size() > outline.links.size()) {
        const UrdfLink& looped = outline.links[start];
        looped.element.Fail("link " + Quote(looped.name) + " hangs on a loop of joints");
      }
      path.push_back(link);
      link = outline.joints[outline.links[link].parent_joint].parent;
    }
    for (int visited : path) on_tree[visited] = true;
  }
}

bool IsFree(const UrdfJoint& joint) { return joint.type == "floating" || joint.type == "planar"; }

/// The parts into which floating and planar joints divide a URDF, each identified by its root link.
class Parts {
 public:
  explicit Parts(const UrdfOutline& outline) : root_(outline.links.size()) {
    for (int link = 0; link < static_cast<int>(outline.links.size()); ++link) {
      root_[link] = RootOf(outline, link);
      ++parts_[root_[link]].links;
    }
    for (const UrdfJoint& joint : outline.joints) {
      if (joint.type != "fixed" && !IsFree(joint)) ++parts_[root_[joint.child]].movable;
    }
  }

  bool Has(int root, int link) const { return root_[link] == root; }
  int movable(int root) const { return parts_.at(root).movable; }

  /// Root link of the part that is the robot: the part with the most movable joints; of several,
  /// the one with the most links; of these, rather not the part of the URDF's root.
  int Robot(const UrdfOutline& outline) const {
    int best = -1;
    const auto rank = [&](int root) {
      const Part& part = parts_.at(root);
      return std::tuple(part.movable, part.links, root != outline.root);
    };
    for (const auto& [root, unused] : parts_) {
      if (best < 0 || rank(root) > rank(best)) best = root;
    }
    return best;
  }

 private:
  struct Part {
    int links = 0, movable = 0;
  };

  static int RootOf(const UrdfOutline& outline, int link) {
    for (;;) {
      const int carrier = outline.links[link].parent_joint;
      if (carrier < 0 || IsFree(outline.joints[carrier])) return link;
      link = outline.joints[carrier].parent;
    }
  }

  std::vector<int> root_;      ///< by link
  std::map<int, Part> parts_;  ///< by root
};

/// Keeps the part that is the robot. Other parts are dropped, and warnings say so, except for a
/// part above the robot without movable joints: it is the world in which the robot is free.
void KeepRobot(UrdfOutline& outline) {
  if (std::none_of(outline.joints.begin(), outline.joints.end(), IsFree)) return;
  const Parts parts(outline);
  const int robot = parts.Robot(outline);
  for (int i = 0; i < static_cast<int>(outline.links.size()); ++i) {
    outline.links[i].dropped = !parts.Has(robot, i);
  }
  for (UrdfJoint& joint : outline.joints) {
    joint.dropped = IsFree(joint) || outline.links[joint.child].dropped;
    if (!IsFree(joint) || joint.child == robot) continue;
    const int left_out = parts.movable(joint.child);
    outline.warnings.push_back(
        "joint " + Quote(joint.name) + " is " + joint.type + ": what it carries (link " +
        Quote(outline.links[joint.child].name) + ") is left out" +
        (left_out > 0 ? ", with " + std::to_string(left_out) + " movable joints" : ""));
  }
  if (robot != outline.root && parts.movable(outline.root) > 0) {
    outline.warnings.push_back("link " + Quote(outline.links[robot].name) +
                               " is taken as the root link; what carries it is left out, with " +
                               std::to_string(parts.movable(outline.root)) + " movable joints");
  }
  outline.root = robot;
}

/// Makes joints fixed that follow a joint that cannot move.
void FixFollowersOfFixed(UrdfOutline& outline) {
  for (bool found = true; found;) {
    found = false;
    for (UrdfJoint& joint : outline.joints) {
      if (joint.dropped || joint.leader < 0 || outline.joints[joint.leader].type != "fixed") {
        continue;
      }
      if (joint.element.Get("mimic").NumberOr("offset", 0.0) != 0.0) continue;
      outline.warnings.push_back("joint " + Quote(joint.name) + " mimics " +
                                 Quote(outline.joints[joint.leader].name) +
                                 ", which is fixed: it is taken as fixed too");
      joint.type = "fixed";
      joint.leader = -1;
      found = true;
    }
  }
}

void CheckMimics(const std::vector<UrdfJoint>& joints) {
  for (const UrdfJoint& joint : joints) {
    if (joint.leader < 0) continue;
    const UrdfJoint& leader = joints[joint.leader];
    const std::string both = "joint " + Quote(joint.name) + " mimics " + Quote(leader.name);
    if (joint.dropped) continue;
    if (leader.dropped) joint.element.Fail(both + ", which is no joint of the robot");
    if (leader.type == "fixed") joint.element.Fail(both + ", which is fixed, with an offset");
    std::size_t steps = 0;
    for (int j = joint.leader; j >= 0; j = joints[j].leader) {
      if (++steps > joints.size()) joint.element.Fail(both + ", and so in the end itself");
    }
  }
}

}  // namespace

UrdfOrigin ReadUrdfOrigin(const XmlElement& parent) {
  UrdfOrigin origin;
  if (const auto element = parent.Find("origin")) {
    if (element->Has("xyz")) origin.xyz = element->Vector("xyz");
    if (element->Has("rpy")) origin.rpy = element->Vector("rpy");
  }
  return origin;
}

UrdfOutline ReadUrdfOutline(const XmlText& xml) {
  const XmlElement robot = xml.Root();
  if (robot.Tag() != "robot") {
    robot.Fail("found <" + std::string(robot.Tag()) + ">; a URDF begins with <robot>");
  }
  UrdfOutline outline;
  ReadEntries(robot, outline);
  for (std::size_t j = 0; j < outline.joints.size(); ++j) {
    ConnectJoint(static_cast<int>(j), outline);
  }
  FindRoot(outline);
  KeepRobot(outline);
  FixFollowersOfFixed(outline);
  CheckMimics(outline.joints);
  return outline;
}

}  // namespace elastocal
