// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/linkage_file.hpp"

#include <map>
#include <string>

#include <yaml-cpp/yaml.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

void EmitPoint(const char* key, const Eigen::Vector3d& numbers, YAML::Emitter& yaml) {
  yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double number : numbers) yaml << FormatNumber(number);
  yaml << YAML::EndSeq;
}

/// The project's own standard deviations.
void EmitUncertain(const Rod& rod, YAML::Emitter& yaml) {
  std::map<std::string, Eigen::Vector3d> points;  // "anchor", "centre": 0 where exact
  yaml << YAML::Key << "uncertain" << YAML::Value << YAML::Flow << YAML::BeginMap;
  for (const auto& [quantity, sd] : rod.uncertain) {
    const std::string name = RodQuantityName(quantity);
    const std::size_t underline = name.find('_');
    if (underline != std::string::npos) {
      Eigen::Vector3d& point =
          points.try_emplace(name.substr(0, underline), Eigen::Vector3d::Zero()).first->second;
      point[name.back() - 'x'] = sd / kMetresPerMm;
      continue;
    }
    const bool turns = quantity == RodQuantity::kZero;
    yaml << YAML::Key << name + (turns ? "_deg" : "_mm") << YAML::Value
         << FormatNumber(sd / (turns ? kRadiansPerDegree : kMetresPerMm));
  }
  for (const auto& [name, point] : points) EmitPoint((name + "_mm").c_str(), point, yaml);
  yaml << YAML::EndMap;
}

void EmitRod(const Rod& rod, const RobotTree& tree, YAML::Emitter& yaml) {
  yaml << YAML::BeginMap << YAML::Key << "motor" << YAML::Value << rod.motor;
  if (rod.actuator) yaml << YAML::Key << "actuator" << YAML::Value << true;
  yaml << YAML::Key << "from" << YAML::Value << tree.links[Size(rod.from_link)].name;
  yaml << YAML::Key << "to" << YAML::Value << tree.links[Size(rod.to_link)].name;
  EmitPoint("centre_mm", rod.centre / kMetresPerMm, yaml);
  if (!rod.actuator) {
    EmitPoint("axis", rod.axis, yaml);
    EmitPoint("pin_mm", rod.pin / kMetresPerMm, yaml);
  }
  EmitPoint("anchor_mm", rod.anchor / kMetresPerMm, yaml);
  yaml << YAML::Key << "length_mm" << YAML::Value << FormatNumber(rod.length / kMetresPerMm);
  EmitUncertain(rod, yaml);
  yaml << YAML::EndMap;
}

void EmitLinkage(const Linkage& linkage, const RobotTree& tree, YAML::Emitter& yaml) {
  yaml << YAML::BeginMap << YAML::Key << "name" << YAML::Value << linkage.name;
  yaml << YAML::Key << "joints" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const int k : linkage.joints) yaml << tree.joints[Size(k)].name;
  yaml << YAML::EndSeq;
  yaml << YAML::Key << "assembled_deg" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double angle : linkage.assembled) yaml << FormatNumber(angle / kRadiansPerDegree);
  yaml << YAML::EndSeq << YAML::Key << "rods" << YAML::Value << YAML::BeginSeq;
  for (const Rod& rod : linkage.rods) EmitRod(rod, tree, yaml);
  yaml << YAML::EndSeq << YAML::EndMap;
}

}  // namespace

std::string MakeLinkagesYaml(const CalibrationResult& result) {
  const RobotTree& tree = result.model.tree;
  const Geometry geometry = ApplyErrors(result.model, result.delta);
  YAML::Emitter yaml;
  yaml << YAML::Comment(
      "Written by elastocal: calibrated rods. Close the loops with the joints of the nominal "
      "URDF;\n"
      "the positions of the joints that result belong to the calibrated one.");
  yaml << YAML::BeginMap << YAML::Key << "linkages" << YAML::Value << YAML::BeginSeq;
  for (std::size_t i = 0; i < tree.linkages.size(); ++i) {
    EmitLinkage(WithErrors(tree.linkages[i], geometry.linkage_errors[i]), tree, yaml);
  }
  yaml << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace elastocal
