#include "elastocal/io/urdf_outline.hpp"

#include <algorithm>
#include <array>

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
  if (!mimic || joint.type == "fixed" || joint.type == "floating") return;
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

/// A floating joint says that the robot stands free in the world: the tree begins below it.
void DropFloatingRoot(UrdfOutline& outline) {
  const int root = outline.root;
  const auto at_root = std::count_if(outline.joints.begin(), outline.joints.end(),
                                     [&](const UrdfJoint& joint) { return joint.parent == root; });
  for (UrdfJoint& joint : outline.joints) {
    if (joint.type != "floating" && joint.type != "planar") continue;
    if (joint.type == "planar" || joint.parent != root || at_root > 1) {
      joint.element.Fail("joint " + Quote(joint.name) + " is " + joint.type +
                         "; joints may be fixed, revolute, continuous or prismatic, and one "
                         "floating joint may be all that the root link carries");
    }
    joint.dropped = true;
    outline.root = joint.child;
  }
}

void CheckMimics(const std::vector<UrdfJoint>& joints) {
  for (const UrdfJoint& joint : joints) {
    if (joint.leader < 0) continue;
    const UrdfJoint& leader = joints[joint.leader];
    const std::string both = "joint " + Quote(joint.name) + " mimics " + Quote(leader.name);
    if (leader.type == "fixed" || leader.dropped) joint.element.Fail(both + ", which is fixed");
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
  DropFloatingRoot(outline);
  CheckMimics(outline.joints);
  return outline;
}

}  // namespace elastocal
