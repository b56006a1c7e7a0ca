// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/held_root.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

std::optional<HeldRoot> FindHeldRoot(const Placement& placement, const Eigen::Vector3d& gravity) {
  std::vector<Eigen::Vector3d> ups;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Footing& footing : placement.footings) {
    if (footing.leg >= 0) continue;
    for (int i : footing.postures) {
      const Eigen::Matrix3d R_ref_root = placement.T_ref_waist[Size(i)].linear();
      ups.emplace_back(R_ref_root.transpose() * -gravity.normalized());
      sum += ups.back();
    }
  }
  if (!(sum.norm() > 0.0)) return std::nullopt;
  HeldRoot held{.up = sum.normalized()};
  for (const Eigen::Vector3d& up : ups) {
    held.differs = std::max(held.differs, std::atan2(held.up.cross(up).norm(), held.up.dot(up)));
  }
  if (held.differs > M_PI / 2.0) return std::nullopt;
  return held;
}

void EmitHeldRoot(const HeldRoot& held, YAML::Emitter& yaml) {
  yaml << YAML::Key << "held_root" << YAML::Value << YAML::Flow << YAML::BeginMap;
  yaml << YAML::Key << "up" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (double number : held.up) yaml << FormatNumber(number);
  yaml << YAML::EndSeq;
  yaml << YAML::Key << "differs_rad" << YAML::Value << FormatNumber(held.differs);
  yaml << YAML::EndMap << YAML::Comment("in the root link's frame; how far single postures differ");
}

std::optional<HeldRoot> ReadHeldRoot(const YamlValue& root) {
  const auto found = root.Find("held_root");
  if (!found) return std::nullopt;
  const YamlValue direction = found->Get("up");
  const std::vector<YamlValue> items = direction.Items();
  direction.Expect(items.size() == 3, "three numbers");
  const Eigen::Vector3d up(items[0].Number(), items[1].Number(), items[2].Number());
  direction.Expect(up.norm() > 0.0, "a direction");
  const YamlValue differs = found->Get("differs_rad");
  differs.Expect(differs.Number() >= 0.0 && differs.Number() <= M_PI, "an angle from 0 to pi");
  return HeldRoot{.up = up.normalized(), .differs = differs.Number()};
}

}  // namespace elastocal
