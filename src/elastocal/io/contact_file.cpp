// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/contact_file.hpp"

#include <yaml-cpp/yaml.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

template <typename Numbers>
void EmitList(const char* key, const Numbers& numbers, YAML::Emitter& yaml) {
  yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) yaml << FormatNumber(numbers[i]);
  yaml << YAML::EndSeq;
}

void EmitFeet(const ObservedRobot& model, YAML::Emitter& yaml) {
  yaml << YAML::Key << "feet" << YAML::Value << YAML::BeginSeq;
  for (const ContactFoot& foot : model.setup.feet) {
    yaml << YAML::BeginMap;
    yaml << YAML::Key << "link" << YAML::Value << model.robot.tree.links[foot.link].name;
    EmitList("xyz_m", foot.T_floor_foot.translation(), yaml);
    EmitList("rpy_rad", ToRpy(foot.T_floor_foot.linear(), Eigen::Vector3d::Zero()), yaml);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq;
}

void EmitFit(const ObservedRobot& model, const ObservationFit& fit, YAML::Emitter& yaml) {
  yaml << YAML::Key << "quantities" << YAML::Value << YAML::BeginSeq;
  for (std::size_t i = 0; i < model.setup.quantities.size(); ++i) {
    const QuantityValue& value = fit.values.quantities[i];
    yaml << YAML::BeginMap;
    yaml << YAML::Key << "name" << YAML::Value << model.setup.quantities[i].name;
    EmitList("origin_xyz_m", value.origin.translation(), yaml);
    EmitList("origin_rpy_rad", ToRpy(value.origin.linear(), Eigen::Vector3d::Zero()), yaml);
    EmitList("values", value.x, yaml);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq;
  yaml << YAML::Key << "spread" << YAML::Value << YAML::BeginMap;
  for (std::size_t s = 0; s < model.setup.sources.size(); ++s) {
    if (model.setup.sources[s].role == Source::Role::kFixed) continue;
    yaml << YAML::Key << model.setup.sources[s].name << YAML::Value
         << FormatNumber(fit.spread.sd[s]);
  }
  yaml << YAML::EndMap;
}

template <int kSize>
Eigen::Matrix<double, kSize, 1> ReadList(const YamlValue& value) {
  const std::vector<YamlValue> items = value.Items();
  value.Expect(items.size() == kSize, std::to_string(kSize) + " numbers");
  Eigen::Matrix<double, kSize, 1> numbers;
  for (int i = 0; i < kSize; ++i) numbers[i] = items[static_cast<std::size_t>(i)].Number();
  return numbers;
}

std::vector<ContactFoot> ReadFeet(const YamlValue& list, const Project& project) {
  std::vector<ContactFoot> feet = project.contact->setup.feet;
  const std::vector<YamlValue> items = list.Items();
  list.Expect(items.size() == feet.size(), "the feet of the project");
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const std::string& link = project.tree.links[feet[i].link].name;
    items[i].Get("link").Expect(items[i].Get("link").Text() == link,
                                "link " + Quote(link) + ", the foot in the project");
    feet[i].T_floor_foot =
        FromXyzRpy(ReadList<3>(items[i].Get("xyz_m")), ReadList<3>(items[i].Get("rpy_rad")));
    feet[i].share = 1.0 / static_cast<double>(feet.size());
  }
  return feet;
}

StoredContact ReadFit(const YamlValue& section, const Project& project) {
  StoredContact stored;
  for (const YamlValue& item : section.Get("quantities").Items()) {
    QuantityValue value;
    value.origin =
        FromXyzRpy(ReadList<3>(item.Get("origin_xyz_m")), ReadList<3>(item.Get("origin_rpy_rad")));
    const std::vector<YamlValue> numbers = item.Get("values").Items();
    value.x.resize(static_cast<Eigen::Index>(numbers.size()));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      value.x[static_cast<Eigen::Index>(i)] = numbers[i].Number();
    }
    stored.quantities[item.Get("name").Text()] = value;
  }
  const ObservationSetup& setup = project.contact->setup;
  for (const Quantity& quantity : setup.quantities) {
    const auto found = stored.quantities.find(quantity.name);
    section.Get("quantities")
        .Expect(found != stored.quantities.end() && found->second.x.size() == quantity.size(),
                Quote(quantity.name) + " with " + std::to_string(quantity.size()) +
                    " values, as the project has it");
  }
  stored.spread = FirstSpread(setup.sources);
  const YamlValue spread = section.Get("spread");
  for (std::size_t s = 0; s < setup.sources.size(); ++s) {
    if (setup.sources[s].role == Source::Role::kFixed) continue;
    // An older file lacks those that came later.
    if (const auto sd = spread.Find(setup.sources[s].name)) {
      stored.spread.sd[s] = sd->Number(kPositive);
    }
  }
  return stored;
}

}  // namespace

std::string MakeContactYaml(const ObservedRobot& model, const ObservationFit& calibrated,
                            const ObservationFit& uncalibrated) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "contact" << YAML::Value << YAML::BeginMap;
  EmitFeet(model, yaml);
  EmitFit(model, calibrated, yaml);
  yaml << YAML::Key << "uncalibrated" << YAML::Value << YAML::BeginMap;
  EmitFit(model, uncalibrated, yaml);
  yaml << YAML::EndMap << YAML::EndMap << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

bool HasContacts(const std::filesystem::path& file) {
  return YamlValue::Parse(ReadFile(file), file.string()).Find("contact").has_value();
}

StoredContacts ReadContacts(const std::filesystem::path& file, const Project& project) {
  const YamlValue root = YamlValue::Parse(ReadFile(file), file.string());
  const auto section = root.Find("contact");
  if (!section) {
    root.Fail(
        "no key 'contact': this calibration was not made from touches or instruments; one "
        "that was is expected, because the project has contact or instruments");
  }
  return {ReadFeet(section->Get("feet"), project), ReadFit(*section, project),
          ReadFit(section->Get("uncalibrated"), project)};
}

}  // namespace elastocal
