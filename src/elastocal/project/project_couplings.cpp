// SPDX-License-Identifier: Apache-2.0
#include "elastocal/project/project_sections.hpp"
#include "elastocal/robot/coupling.hpp"

namespace elastocal {
namespace {

Coupling ReadCoupling(const YamlValue& value, const RobotTree& tree) {
  Coupling coupling;
  coupling.joint = JointNamedBy(value.Get("joint"), tree);
  const bool turns = tree.joints[coupling.joint].type == JointType::kRevolute;
  const char* offset = turns ? "offset_deg" : "offset_mm";
  value.ExpectKeys({"joint", "of", offset});
  const YamlValue of = value.Get("of");  // Entries() belongs to it
  for (const auto& [name, factor] : of.Entries()) {
    const int joint =
        FindNamedBy(factor, [&, &joint_name = name] { return FindJoint(tree, joint_name); });
    coupling.of.emplace_back(joint, factor.Bounded());
    factor.Expect(coupling.of.back().second != 0.0, "a factor other than 0");
  }
  of.Expect(!coupling.of.empty(), "joints and their factors");
  if (const auto given = value.Find(offset)) {
    coupling.offset = (turns ? kOneDegree : kOneMm) * given->Bounded();
  }
  return coupling;
}

}  // namespace

void ReadCouplings(const YamlValue& section, Project& project) {
  std::vector<Coupling> couplings;
  for (const YamlValue& value : section.Items()) {
    couplings.push_back(ReadCoupling(value, project.tree));
    // Called for each coupling, so that an error is reported with this one.
    FindNamedBy(value, [&] { return Couple(project.tree, couplings); });
  }
  project.tree = Couple(project.tree, couplings);
}

}  // namespace elastocal
