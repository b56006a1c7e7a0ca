// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "elastocal/math/transform.hpp"
#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostContacts = 100;

void ReadFoot(const YamlValue& value, Project& project) {
  ContactProject& contact = *project.contact;
  value.ExpectKeys({"link", "position_mm"});
  ContactFoot foot;
  foot.link = LinkNamedBy(value.Get("link"), project.tree);
  if (project.tree.links[foot.link].body == 0) {
    value.Get("link").Fail("no joint moves this link against the root link; a foot was expected");
  }
  for (const ContactFoot& other : contact.setup.feet) {
    if (other.link == foot.link) value.Get("link").Fail("the foot comes twice");
  }
  const auto position = value.Find("position_mm");
  if (position) foot.T_floor_foot.translation() = PointFromMm(*position);
  if (position && contact.setup.feet.empty() && !foot.T_floor_foot.translation().isZero()) {
    position->Fail("the first foot is where positions are counted from: [0, 0, 0]");
  }
  contact.setup.feet.push_back(foot);
  contact.foot_placed.push_back(position ? 1 : 0);
}

/// Axes whose z is the normal.
Eigen::Matrix3d FaceAxes(const YamlValue& value) {
  return RotationBetween(Eigen::Vector3d::UnitZ(), DirectionFrom(value));
}

TableTop ReadTable(const YamlValue& value) {
  value.ExpectKeys({"centre_mm", "size_mm"});
  TableTop table{PointFromMm(value.Get("centre_mm")), {}};
  const YamlValue size = value.Get("size_mm");
  const std::vector<YamlValue> sides = size.Items();
  size.Expect(sides.size() == 2, "two numbers, along x and y");
  for (int i = 0; i < 2; ++i) table.size[i] = kOneMm * sides[i].Bounded();
  return table;
}

void ReadPlate(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "point_mm", "normal", "table"});
  ContactPlate plate;
  CheckFileName(value.Get("name"));
  plate.name = NewName(value.Get("name"), "plate", project.contact->setup.plates);
  plate.link = LinkNamedBy(value.Get("link"), project.tree);
  if (project.tree.links[plate.link].body == 0) {
    value.Get("link").Fail("no joint moves this link against the root link");
  }
  if (const auto point = value.Find("point_mm")) plate.face.p_link_face = PointFromMm(*point);
  if (const auto normal = value.Find("normal")) plate.face.R_link_face = FaceAxes(*normal);
  const auto table = value.Find("table");
  project.contact->tables.push_back(table ? std::optional(ReadTable(*table)) : std::nullopt);
  AddPlate(project.contact->setup, plate);
  project.contact->columns.emplace_back();
}

std::vector<std::string> Texts(const YamlValue& list) {
  std::vector<std::string> texts;
  for (const YamlValue& item : list.Items()) texts.push_back(item.Text());
  list.Expect(!texts.empty(), "at least one name");
  return texts;
}

void ReadSessions(const YamlValue& section, SessionRule& rule) {
  section.ExpectKeys({"column", "counts", "from_encoders"});
  const auto column = section.Find("column");
  const auto counts = section.Find("counts");
  const auto encoders = section.Find("from_encoders");
  const int given = int{column.has_value()} + int{counts.has_value()} + int{encoders.has_value()};
  section.Expect(given == 1, "either column, counts or from_encoders");
  if (encoders) rule.from_encoders = encoders->Boolean();
  if (column) rule.columns = {column->Text()};
  if (!counts) return;
  counts->ExpectKeys({"columns", "quantum", "modulo"});
  rule.columns = Texts(counts->Get("columns"));
  rule.quantum = counts->Get("quantum").Bounded();
  constexpr std::int64_t kMostSteps = 1000000000;
  rule.modulo = counts->Get("modulo").Integer(2, kMostSteps);
}

}  // namespace

void ReadContact(const YamlValue& section, bool instruments, Project& project) {
  section.ExpectKeys({"feet", "plates", "plate_column", "sessions", "common"});
  project.contact.emplace();
  ObservationSetup& setup = project.contact->setup;
  const auto list = [&](const char* key, bool needed) {
    const std::optional<YamlValue> found = needed ? section.Get(key) : section.Find(key);
    if (!found) return std::vector<YamlValue>();
    std::vector<YamlValue> items = found->Items();
    found->Expect(!items.empty() && items.size() <= kMostContacts, std::string("1 to 100 ") + key);
    return items;
  };
  for (const YamlValue& plate : list("plates", !instruments)) ReadPlate(plate, project);
  for (const YamlValue& foot : list("feet", false)) ReadFoot(foot, project);
  if (const auto column = section.Find("plate_column")) {
    project.contact->plate_column = column->Text();
  }
  if (const auto sessions = section.Find("sessions")) {
    ReadSessions(*sessions, project.contact->sessions);
  }
  if (const auto common = section.Find("common")) {
    for (const YamlValue& group : common->Items()) setup.common.push_back(Texts(group));
  }
}

}  // namespace elastocal
