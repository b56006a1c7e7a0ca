// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/semantics.hpp"

#include <algorithm>

#include "elastocal/files/xml_element.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

SemanticGroup ReadGroup(const XmlElement& element) {
  SemanticGroup group;
  group.name = element.Text("name");
  for (const XmlElement& part : element.Children()) {
    if (part.Tag() == "chain" && group.tip_link.empty()) group.tip_link = part.Text("tip_link");
    if (part.Tag() == "joint") group.joints.push_back(part.Text("name"));
  }
  return group;
}

std::map<std::string, double> ReadState(const XmlElement& element) {
  std::map<std::string, double> positions;
  for (const XmlElement& joint : element.Children()) {
    if (joint.Tag() != "joint") continue;
    if (const auto value = ParseNumber(joint.Text("value"))) positions[joint.Text("name")] = *value;
  }
  return positions;
}

}  // namespace

Semantics ParseSemantics(const std::string& text, const std::string& source) {
  const XmlText xml(text, source);
  const XmlElement root = xml.Root();
  if (root.Tag() != "robot") {
    root.Fail("found <" + std::string(root.Tag()) + ">; an SRDF begins with <robot>");
  }
  Semantics semantics;
  semantics.source = source;
  for (const XmlElement& element : root.Children()) {
    if (element.Tag() == "group") semantics.groups.push_back(ReadGroup(element));
    if (element.Tag() == "end_effector") {
      semantics.end_links.push_back(element.Text("parent_link"));
    }
    if (element.Tag() == "group_state") {
      semantics.states.emplace_back(element.Text("name"), ReadState(element));
    }
    if (element.Tag() == "disable_collisions") {
      const std::string one = element.Text("link1"), other = element.Text("link2");
      semantics.apart.insert(std::minmax(one, other));
    }
  }
  if (semantics.groups.empty() && semantics.states.empty() && semantics.end_links.empty() &&
      semantics.apart.empty()) {
    root.Fail("there is no group, state, end effector or pair of links in it; is this an SRDF?");
  }
  return semantics;
}

void CheckBelongs(const Semantics& semantics, const RobotTree& tree) {
  if (semantics.source.empty()) return;
  std::set<std::string> names(semantics.end_links.begin(), semantics.end_links.end());
  for (const SemanticGroup& group : semantics.groups) {
    names.insert(group.tip_link);
    names.insert(group.joints.begin(), group.joints.end());
  }
  for (const auto& [state, positions] : semantics.states) {
    for (const auto& [joint, position] : positions) names.insert(joint);
  }
  for (const auto& [one, other] : semantics.apart) names.insert({one, other});
  names.erase("");
  const auto named = [&](const auto& part) { return names.contains(part.name); };
  if (names.empty() || std::ranges::any_of(tree.joints, named) ||
      std::ranges::any_of(tree.links, named)) {
    return;
  }
  throw InputError(semantics.source + ": names no joint and no link of robot '" + tree.name +
                   "' (but " + Quote(*names.begin()) + "); the SRDF of this robot was expected");
}

}  // namespace elastocal
