// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/mjcf_defaults.hpp"

#include <algorithm>

#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr const char* kOutermost = "main";  // MuJoCo's name of the class that names none

}  // namespace

MjcfJointDefaults::MjcfJointDefaults(const XmlElement& mujoco) {
  classes_[kOutermost];
  for (const XmlElement& section : mujoco.Children()) {
    if (section.Tag() != "default") continue;
    Collect(section, kOutermost, "");
    if (section.Has("class") && section.Text("class") != kOutermost) {
      classes_[section.Text("class")].around = kOutermost;
    }
  }
}

void MjcfJointDefaults::Collect(const XmlElement& section, const std::string& name,
                                const std::string& around) {
  classes_[name].around = around;
  for (const XmlElement& child : section.Children()) {
    if (child.Tag() == "joint") classes_[name].entries.push_back(child);
    // Each class is entered once, because a class within itself would never end.
    if (child.Tag() == "default" && !classes_.contains(child.Text("class"))) {
      Collect(child, child.Text("class"), name);
    }
  }
}

std::optional<XmlElement> MjcfJointDefaults::Giver(const XmlElement& joint,
                                                   const std::string& childclass,
                                                   const char* attribute) const {
  if (joint.Has(attribute)) return joint;
  std::string name = joint.Has("class") ? joint.Text("class") : childclass;
  if (name.empty()) name = kOutermost;
  while (!name.empty()) {
    const auto found = classes_.find(name);
    if (found == classes_.end()) {
      joint.Fail("the file has no default class " + Quote(name) +
                 "; the model as MuJoCo saves it was expected");
    }
    const std::vector<XmlElement>& entries = found->second.entries;
    const auto giver = std::find_if(entries.rbegin(), entries.rend(),
                                    [&](const auto& entry) { return entry.Has(attribute); });
    if (giver != entries.rend()) return *giver;
    name = found->second.around;
  }
  return {};
}

}  // namespace elastocal
