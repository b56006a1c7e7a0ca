#include "elastocal/io/urdf_outline.hpp"

#include <algorithm>
#include <array>

#include <tinyxml2.h>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

// urdfdom destroys a chain of links recursively, and no robot has more.
constexpr std::size_t kMostLinks = 5000;
const std::array<std::string, 6> kJointTypes = {"revolute", "continuous", "prismatic",
                                                "fixed",    "floating",   "planar"};

std::vector<std::string> Names(const std::map<std::string, int>& index) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : index) names.push_back(name);
  return names;
}

std::string UniqueName(const UrdfElement& element, const char* what,
                       std::map<std::string, int>& index) {
  const std::string name = element.Text("name");
  if (!index.emplace(name, static_cast<int>(index.size())).second) {
    element.Fail(std::string("second ") + what + " of the name " + Quote(name));
  }
  if (index.size() > kMostLinks) {
    element.Fail("more than " + std::to_string(kMostLinks) + " " + what + "s");
  }
  return name;
}

UrdfJointEntry ReadJoint(const UrdfElement& element, UrdfOutline& outline) {
  UrdfJointEntry entry{{}, element, {}};
  UrdfJoint& joint = entry.joint;
  joint.name = UniqueName(element, "joint", outline.joint_index);
  joint.type = element.Text("type");
  if (std::find(kJointTypes.begin(), kJointTypes.end(), joint.type) == kJointTypes.end()) {
    element.Fail("joint " + Quote(joint.name) + " is of the unknown type " + Quote(joint.type) +
                 DidYouMean(joint.type.substr(0, 60), kJointTypes));
  }
  joint.parent = element.Get("parent").Text("link");
  joint.child = element.Get("child").Text("link");
  joint.origin = ReadUrdfOrigin(element);
  const auto mimic = element.Find("mimic");
  if (mimic && joint.type != "fixed") entry.mimic = mimic->Text("joint");
  return entry;
}

UrdfOutline ReadEntries(const tinyxml2::XMLElement& root, const std::string& source) {
  UrdfOutline outline;
  outline.robot = UrdfElement(root, source).Text("name");
  for (const tinyxml2::XMLElement* xml = root.FirstChildElement(); xml != nullptr;
       xml = xml->NextSiblingElement()) {
    const std::string tag = xml->Name();
    const UrdfElement element(*xml, source);
    if (tag == "link") {
      const std::string name = UniqueName(element, "link", outline.link_index);
      outline.links.push_back({name, element});
    } else if (tag == "joint") {
      outline.joints.push_back(ReadJoint(element, outline));
    } else if (tag.rfind("xacro:", 0) == 0) {
      element.Fail("found <" + tag + ">: this is a xacro file; expand it to a URDF first");
    }
  }
  return outline;
}

int KnownLink(const UrdfOutline& outline, const UrdfJointEntry& entry, const char* which,
              const std::string& name) {
  const auto found = outline.link_index.find(name);
  if (found == outline.link_index.end()) {
    entry.element.Fail("joint " + Quote(entry.joint.name) + ": " + which + " link " + Quote(name) +
                       " is not in the file" +
                       DidYouMean(name.substr(0, 60), Names(outline.link_index)));
  }
  return found->second;
}

void ConnectLinks(UrdfOutline& outline) {
  for (std::size_t j = 0; j < outline.joints.size(); ++j) {
    const UrdfJointEntry& entry = outline.joints[j];
    KnownLink(outline, entry, "parent", entry.joint.parent);
    UrdfLinkEntry& child = outline.links[KnownLink(outline, entry, "child", entry.joint.child)];
    if (child.parent_joint >= 0) {
      entry.element.Fail("link " + Quote(child.name) + " is the child of joint " +
                         Quote(entry.joint.name) + " and of joint " +
                         Quote(outline.joints[child.parent_joint].joint.name) +
                         "; a link has one parent");
    }
    child.parent_joint = static_cast<int>(j);
  }
}

/// Finds the only link without a parent. With one parent each, links that do not hang on it form a
/// loop.
void FindRoot(UrdfOutline& outline) {
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const UrdfLinkEntry& link = outline.links[i];
    if (link.parent_joint >= 0) continue;
    if (outline.root >= 0) {
      link.element.Fail("links " + Quote(outline.links[outline.root].name) + " and " +
                        Quote(link.name) + " both have no parent; a robot has one root");
    }
    outline.root = static_cast<int>(i);
  }
  std::vector<bool> on_tree(outline.links.size(), false);
  for (const UrdfLinkEntry& start : outline.links) {
    std::vector<int> path;
    int link = outline.link_index.at(start.name);
    while (!on_tree[link] && outline.links[link].parent_joint >= 0) {
      if (path.size() > outline.links.size()) {
        start.element.Fail("link " + Quote(start.name) + " hangs on a loop of joints");
      }
      path.push_back(link);
      const UrdfJointEntry& parent = outline.joints[outline.links[link].parent_joint];
      link = outline.link_index.at(parent.joint.parent);
    }
    for (int visited : path) on_tree[visited] = true;
  }
}

/// A floating joint says that the robot stands free in the world: the tree begins below it.
void DropFloatingRoot(UrdfOutline& outline) {
  int joints_at_root = 0;
  const std::string root = outline.links[outline.root].name;
  for (const UrdfJointEntry& entry : outline.joints) joints_at_root += entry.joint.parent == root;
  for (UrdfJointEntry& entry : outline.joints) {
    UrdfJoint& joint = entry.joint;
    if (joint.type != "floating" && joint.type != "planar") continue;
    if (joint.type == "planar" || joint.parent != root || joints_at_root > 1) {
      entry.element.Fail("joint " + Quote(joint.name) + " is " + joint.type +
                         "; joints may be fixed, revolute, continuous or prismatic, and one "
                         "floating joint may be all that the root link carries");
    }
    joint.dropped = true;
    outline.root = outline.link_index.at(joint.child);
  }
}

/// For every joint the one that it mimics, -1 where it mimics none.
std::vector<int> MimicLeaders(const UrdfOutline& outline) {
  std::vector<int> leaders;
  for (const UrdfJointEntry& entry : outline.joints) {
    leaders.push_back(-1);
    if (entry.mimic.empty()) continue;
    const auto found = outline.joint_index.find(entry.mimic);
    const std::string both = "joint " + Quote(entry.joint.name) + " mimics " + Quote(entry.mimic);
    if (found == outline.joint_index.end()) {
      entry.element.Fail(both + ", which is not in the file" +
                         DidYouMean(entry.mimic.substr(0, 60), Names(outline.joint_index)));
    }
    const UrdfJoint& leader = outline.joints[found->second].joint;
    if (leader.type == "fixed" || leader.dropped) entry.element.Fail(both + ", which is fixed");
    leaders.back() = found->second;
  }
  return leaders;
}

void CheckMimics(const UrdfOutline& outline) {
  const std::vector<int> leaders = MimicLeaders(outline);
  for (std::size_t j = 0; j < leaders.size(); ++j) {
    std::size_t steps = 0;
    for (int leader = leaders[j]; leader >= 0; leader = leaders[leader]) {
      if (++steps <= leaders.size()) continue;
      const UrdfJointEntry& entry = outline.joints[j];
      entry.element.Fail("joint " + Quote(entry.joint.name) + " mimics " + Quote(entry.mimic) +
                         ", and so in the end itself");
    }
  }
}

}  // namespace

UrdfOrigin ReadUrdfOrigin(const UrdfElement& parent) {
  UrdfOrigin origin;
  if (const auto element = parent.Find("origin")) {
    if (element->Has("xyz")) origin.xyz = element->Vector("xyz");
    if (element->Has("rpy")) origin.rpy = element->Vector("rpy");
  }
  return origin;
}

UrdfOutline ReadUrdfOutline(const tinyxml2::XMLElement& robot, const std::string& source) {
  UrdfOutline outline = ReadEntries(robot, source);
  if (outline.links.empty()) UrdfElement(robot, source).Fail("the robot has no <link>");
  ConnectLinks(outline);
  FindRoot(outline);
  DropFloatingRoot(outline);
  CheckMimics(outline);
  return outline;
}

}  // namespace elastocal
