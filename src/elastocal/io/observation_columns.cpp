// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/observation_columns.hpp"

#include <algorithm>
#include <span>

#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr const char* kFrameColumnName = "frame";

void CheckObservedJoints(const Table& table, const Project& project,
                         const ObservationColumns& columns) {
  const RobotTree& tree = project.tree;
  const ObservationSetup& setup = project.contact->setup;
  std::vector<int> links;
  for (const ContactFoot& foot : setup.feet) links.push_back(foot.link);
  const bool may_touch = columns.plate >= 0 || project.contact->plate_column.empty();
  for (std::size_t i = 0; i < setup.instruments.size(); ++i) {
    const bool plate = i < setup.plates.size();
    const bool image = !plate && project.contact->columns[i].empty();
    if (plate ? !may_touch : image ? columns.frame < 0 : columns.instruments[i].empty()) continue;
    const std::vector<int>& of = setup.instruments[i]->links;
    links.insert(links.end(), of.begin(), of.end());
  }
  for (int link : links) {
    for (int k : JointsToBody(tree, tree.links[link].body)) {
      const int coordinate = tree.joints[k].coordinate;
      const std::string& name = JointOfCoordinate(tree, coordinate).name;
      if (columns.coordinates[coordinate] >= 0 || project.recording.not_recorded.contains(name)) {
        continue;
      }
      table.Fail("the column " + Quote(JointColumn(project, name)) + " of joint " + Quote(name) +
                 ", which moves link " + Quote(tree.links[link].name) +
                 ", is missing; a joint that stood still is given in recording.not_recorded_deg "
                 "(or _mm) of " +
                 project.file.string());
    }
  }
}

int FindSessionColumn(const Table& table, const std::string& column, const Project& project) {
  const auto found = std::find(table.header().begin(), table.header().end(), column);
  if (found == table.header().end()) {
    table.Fail("there is no column " + Quote(column) + ", by which contact.sessions of " +
               project.file.string() + " tells sessions apart" +
               DidYouMean(column.substr(0, 60), table.header()));
  }
  return static_cast<int>(found - table.header().begin());
}

/// Adds the columns of instruments to the roles. Returns the first quantity of each instrument; its
/// other quantities follow.
std::vector<int> AddInstrumentRoles(const Project& project, int& quantities, ColumnRoles& roles) {
  std::vector<int> first;
  for (const std::vector<std::string>& columns : project.contact->columns) {
    first.push_back(quantities);
    for (const std::string& column : columns) AddRole(project, column, quantities++, roles);
  }
  return first;
}

/// The columns of an instrument in a table; empty if it has none.
std::vector<int> InstrumentColumns(const Table& table, const Project& project,
                                   std::size_t instrument, std::span<const int> found) {
  const std::vector<std::string>& names = project.contact->columns[instrument];
  if (names.empty() ||
      !HasGroup(table, found, names,
                "instrument " + Quote(project.contact->setup.instruments[instrument]->name))) {
    return {};
  }
  return {found.begin(), found.end()};
}

}  // namespace

bool ObservationColumns::measures() const {
  return frame >= 0 || std::any_of(instruments.begin(), instruments.end(),
                                   [](const std::vector<int>& of) { return !of.empty(); });
}

ObservationColumns FindObservationColumns(const Table& table, const Project& project) {
  const RobotTree& tree = project.tree;
  const ContactProject& contact = *project.contact;
  ColumnRoles roles;
  int quantities = 0;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    AddRole(project, JointColumn(project, JointOfCoordinate(tree, c).name), quantities++, roles);
  }
  const std::vector<int> first = AddInstrumentRoles(project, quantities, roles);
  const int plate = quantities;
  if (!contact.plate_column.empty()) AddRole(project, contact.plate_column, quantities++, roles);
  const int frame = quantities;
  if (!contact.seen_tags.empty()) AddRole(project, kFrameColumnName, quantities++, roles);
  roles.emplace(project.recording.time, kPassedOver);
  for (const std::string& column : contact.sessions.columns) roles.emplace(column, kPassedOver);
  for (const Joint& joint : tree.joints) {
    if (joint.mimic) roles.emplace(joint.name, kPassedOver);
  }
  ObservationColumns columns;
  const std::vector<int> found =
      FindRecordingColumns(table, std::move(roles), static_cast<std::size_t>(quantities), project);
  columns.coordinates.assign(found.begin(), found.begin() + tree.coordinate_count());
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::span<const int> own(found.begin() + first[i], contact.columns[i].size());
    columns.instruments.push_back(InstrumentColumns(table, project, i, own));
  }
  if (!contact.seen_tags.empty()) columns.frame = found[frame];
  if (!contact.plate_column.empty()) {
    columns.plate = found[plate];
    if (columns.plate < 0 && !columns.measures()) {
      table.Fail("the column " + Quote(contact.plate_column) +
                 ", which names the plate that touches, is missing");
    }
  }
  for (const std::string& column : contact.sessions.columns) {
    columns.sessions.push_back(FindSessionColumn(table, column, project));
  }
  for (std::size_t c = 0; c < table.header().size(); ++c) {
    const std::vector<std::string>& ignored = project.recording.ignore;
    if (std::find(ignored.begin(), ignored.end(), table.header()[c]) == ignored.end()) continue;
    columns.ignored.push_back(static_cast<int>(c));
  }
  if (contact.setup.plates.empty() && !columns.measures()) {
    const std::vector<std::string>& of = contact.columns.front();
    table.Fail("there is no column of any instrument of " + project.file.string() + "; " +
               Quote(of.empty() ? kFrameColumnName : of.front()) + " is one of " +
               Quote(contact.setup.instruments.front()->name));
  }
  CheckObservedJoints(table, project, columns);
  return columns;
}

}  // namespace elastocal
