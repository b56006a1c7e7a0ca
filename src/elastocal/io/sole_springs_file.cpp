// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/sole_springs_file.hpp"

#include <cmath>
#include <set>
#include <string>

#include <yaml-cpp/yaml.h>

#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr const char* kSoleUnit = "m/N";
constexpr int kMostLoadChanges = 1000000;

SoleSpring ReadSpring(const YamlValue& item) {
  SoleSpring spring;
  spring.leg = item.Get("leg").Text();
  item.Get("unit").Expect(item.Get("unit").Text() == kSoleUnit, std::string(kSoleUnit));
  spring.compliance = item.Get("value").Number(
      {.lower = -kSoftestSole, .upper = kSoftestSole, .with_lower = true, .with_upper = true});
  spring.sd = item.Get("sd").Number();
  item.Get("sd").Expect(spring.sd > 0.0, "a number above 0");
  spring.interval_factor = item.Get("interval_95_in_sd").Number();
  item.Get("interval_95_in_sd")
      .Expect(spring.interval_factor >= 1.95 && spring.interval_factor <= 12.8,
              "1.96 (normal distribution) to 12.7 (one degree of freedom)");
  spring.changes = static_cast<int>(item.Get("changes").Integer(1, kMostLoadChanges));
  return spring;
}

}  // namespace

void EmitSoleSprings(const std::vector<SoleSpring>& springs, YAML::Emitter& yaml) {
  bool any = false;
  for (const SoleSpring& spring : springs) {
    if (!std::isfinite(spring.sd)) continue;
    if (!any) {
      yaml << YAML::Key << "soles" << YAML::Value
           << YAML::Comment("how far the markers of a foot sink by the load on its sole");
      yaml << YAML::BeginSeq;
      any = true;
    }
    yaml << YAML::Flow << YAML::BeginMap;
    yaml << YAML::Key << "leg" << YAML::Value << spring.leg;
    yaml << YAML::Key << "unit" << YAML::Value << kSoleUnit;
    yaml << YAML::Key << "value" << YAML::Value << FormatNumber(spring.compliance);
    yaml << YAML::Key << "sd" << YAML::Value << FormatNumber(spring.sd);
    yaml << YAML::Key << "interval_95_in_sd" << YAML::Value << FormatNumber(spring.interval_factor);
    yaml << YAML::Key << "changes" << YAML::Value << spring.changes << YAML::EndMap;
  }
  if (any) yaml << YAML::EndSeq;
}

std::vector<SoleSpring> ReadSoleSprings(const YamlValue& root) {
  std::vector<SoleSpring> springs;
  const auto list = root.Find("soles");
  if (!list) return springs;
  std::set<std::string> legs;
  for (const YamlValue& item : list->Items()) {
    springs.push_back(ReadSpring(item));
    item.Get("leg").Expect(legs.insert(springs.back().leg).second, "every leg once");
  }
  return springs;
}

}  // namespace elastocal
