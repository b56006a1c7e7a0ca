#include "elastocal/io/contact_file.hpp"

#include <yaml-cpp/yaml.h>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/yaml_value.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

template <typename Numbers>
void EmitList(const char* key, const Numbers& numbers, YAML::Emitter& yaml) {
  yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) yaml << FormatNumber(numbers[i]);
  yaml << YAML::EndSeq;
}

void EmitFeet(const ContactModel& model, YAML::Emitter& yaml) {
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

void EmitFit(const ContactModel& model, const ContactFit& fit, YAML::Emitter& yaml) {
  yaml << YAML::Key << "plates" << YAML::Value << YAML::BeginSeq;
  for (std::size_t p = 0; p < model.setup.plates.size(); ++p) {
    const TablePlane& table = fit.values.tables[p];
    yaml << YAML::BeginMap;
    yaml << YAML::Key << "name" << YAML::Value << model.setup.plates[p].name;
    EmitList("tilts_rad", fit.values.plate_tilts[p], yaml);
    EmitList("table_pivot_m", table.pivot, yaml);
    yaml << YAML::Key << "table_height_m" << YAML::Value << FormatNumber(table.height_tilts[0]);
    EmitList("table_tilts_rad", table.height_tilts.tail<2>(), yaml);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq;
  yaml << YAML::Key << "spread" << YAML::Value << YAML::BeginMap;
  for (int s = 0; s < kContactSourceCount; ++s) {
    yaml << YAML::Key << ContactSourceName(static_cast<ContactSource>(s)) << YAML::Value
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
  const std::vector<ContactPlate>& plates = project.contact->setup.plates;
  const YamlValue list = section.Get("plates");
  const std::vector<YamlValue> items = list.Items();
  list.Expect(items.size() == plates.size(), "the plates of the project");
  for (std::size_t p = 0; p < plates.size(); ++p) {
    items[p].Get("name").Expect(items[p].Get("name").Text() == plates[p].name,
                                Quote(plates[p].name) + ", the plate in the project");
    stored.plate_tilts.push_back(ReadList<2>(items[p].Get("tilts_rad")));
    TablePlane table;
    table.pivot = ReadList<3>(items[p].Get("table_pivot_m"));
    table.height_tilts << items[p].Get("table_height_m").Number(),
        ReadList<2>(items[p].Get("table_tilts_rad"));
    stored.tables.push_back(table);
  }
  const YamlValue spread = section.Get("spread");
  for (int s = 0; s < kContactSourceCount; ++s) {
    stored.spread.sd[s] =
        spread.Get(ContactSourceName(static_cast<ContactSource>(s))).Number(kPositive);
  }
  return stored;
}

}  // namespace

std::string MakeContactYaml(const ContactModel& model, const ContactFit& calibrated,
                            const ContactFit& uncalibrated) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "contact" << YAML::Value << YAML::BeginMap;
  EmitFeet(model, yaml);
  EmitFit(model, calibrated, yaml);
  yaml << YAML::Key << "uncalibrated" << YAML::Value << YAML::BeginMap;
  EmitFit(model, uncalibrated, yaml);
  yaml << YAML::EndMap << YAML::EndMap << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

StoredContacts ReadContacts(const std::filesystem::path& file, const Project& project) {
  const YamlValue root = YamlValue::Parse(ReadFile(file), file.string());
  const auto section = root.Find("contact");
  if (!section) {
    root.Fail(
        "no key 'contact': this calibration was not made from touches; one that was is "
        "expected, because the project has contact");
  }
  return {ReadFeet(section->Get("feet"), project), ReadFit(*section, project),
          ReadFit(section->Get("uncalibrated"), project)};
}

}  // namespace elastocal
