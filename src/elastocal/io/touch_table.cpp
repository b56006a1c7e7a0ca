#include "elastocal/io/touch_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/contact/standing_robot.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kMostTouches = 20000;
constexpr double kMostSteps = 1e15;  // counts beyond are no whole numbers

/// One table as it was read.
struct TouchFile {
  Recording postures;  // no markers
  std::vector<std::string> sessions, plates;
};

struct TouchColumns {
  std::vector<int> coordinates;
  std::vector<int> sessions;
  int plate = -1;
};

const std::string& NameOfCoordinate(const RobotTree& tree, int coordinate) {
  return tree.joints[tree.coordinate_joint[coordinate]].name;
}

/// Throws InputError for a joint that moves a foot or plate and is not known.
void CheckContactJoints(const Table& table, const Project& project, const TouchColumns& columns) {
  const RobotTree& tree = project.tree;
  std::vector<int> links;
  for (const ContactFoot& foot : project.contact->setup.feet) links.push_back(foot.link);
  for (const ContactPlate& plate : project.contact->setup.plates) links.push_back(plate.link);
  for (int link : links) {
    for (int k : JointsToBody(tree, tree.links[link].body)) {
      const int coordinate = tree.joints[k].coordinate;
      const std::string& name = NameOfCoordinate(tree, coordinate);
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

TouchColumns FindTouchColumns(const Table& table, const Project& project) {
  const RobotTree& tree = project.tree;
  const SessionRule& rule = project.contact->sessions;
  ColumnRoles roles;
  int quantities = 0;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    AddRole(project, JointColumn(project, NameOfCoordinate(tree, c)), quantities++, roles);
  }
  const int plate = quantities;
  if (!project.contact->plate_column.empty()) {
    AddRole(project, project.contact->plate_column, quantities++, roles);
  }
  roles.emplace(project.recording.time, kPassedOver);
  for (const std::string& column : rule.columns) roles.emplace(column, kPassedOver);
  for (const Joint& joint : tree.joints) {
    if (joint.mimic) roles.emplace(joint.name, kPassedOver);
  }
  TouchColumns columns;
  const std::vector<int> found =
      FindRecordingColumns(table, std::move(roles), static_cast<std::size_t>(quantities), project);
  columns.coordinates.assign(found.begin(), found.begin() + tree.coordinate_count());
  if (!project.contact->plate_column.empty()) {
    columns.plate = found[plate];
    if (columns.plate < 0) {
      table.Fail("the column " + Quote(project.contact->plate_column) +
                 ", which names the plate that touches, is missing");
    }
  }
  for (const std::string& column : rule.columns) {
    columns.sessions.push_back(FindSessionColumn(table, column, project));
  }
  CheckContactJoints(table, project, columns);
  return columns;
}

/// What the row read last has for its session.
std::string SessionKey(const Table& table, const TouchColumns& columns, const SessionRule& rule) {
  std::string key;
  for (int column : columns.sessions) {
    if (!key.empty()) key += "/";
    if (rule.quantum <= 0.0) {
      key += std::string(table.Cell(column));
      continue;
    }
    const double steps = std::round(table.Number(column) / rule.quantum);
    if (!(std::abs(steps) < kMostSteps)) {
      table.FailCell(column, "this is no number of steps of contact.sessions.counts.quantum");
    }
    const std::int64_t count = static_cast<std::int64_t>(steps) % rule.modulo;
    key += std::to_string(count < 0 ? count + rule.modulo : count);
  }
  return key;
}

TouchFile ReadTouchFile(const std::filesystem::path& file, const Project& project) {
  std::istringstream stream = OpenTable(file);
  Table table(stream, file.string());
  const TouchColumns columns = FindTouchColumns(table, project);
  const RobotTree& tree = project.tree;
  TouchFile result;
  Recording& postures = result.postures;
  postures.source = file.string();
  std::vector<double> q;
  while (table.Next()) {
    if (table.row_count() > kMostTouches) table.Fail("more than 20000 rows; one a touch expected");
    postures.line.push_back(table.line());
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const auto given = project.recording.not_recorded.find(NameOfCoordinate(tree, c));
      const double elsewhere = given == project.recording.not_recorded.end() ? 0.0 : given->second;
      q.push_back(columns.coordinates[c] < 0 ? elsewhere : table.Number(columns.coordinates[c]));
    }
    result.sessions.push_back(SessionKey(table, columns, project.contact->sessions));
    if (columns.plate >= 0) result.plates.emplace_back(table.Cell(columns.plate));
  }
  if (postures.line.empty()) {
    throw InputError(table.source() + ": no row below the header; touches expected");
  }
  postures.q = StackRows(q, postures.line.size());
  postures.markers.resize(postures.q.rows(), 0);
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    if (columns.coordinates[c] < 0) {
      postures.joints_not_recorded.push_back(NameOfCoordinate(tree, c));
    }
  }
  CheckPlausible(postures, tree);
  return result;
}

/// The plates of a file's touches: as its column says, or as they lie.
std::vector<int> PlatesOf(const TouchFile& file, const Project& project,
                          const ContactSetup& setup) {
  if (file.plates.empty()) {
    return FindTouchingPlates(project.tree, setup, file.postures.q, file.postures.source);
  }
  std::vector<std::string> names;
  for (const ContactPlate& plate : setup.plates) names.push_back(plate.name);
  std::vector<int> plates;
  for (std::size_t i = 0; i < file.plates.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), file.plates[i]);
    if (found == names.end()) {
      throw InputError(Place(file.postures.source, file.postures.line[i]) + "there is no plate " +
                       Quote(file.plates[i]) + DidYouMean(file.plates[i].substr(0, 60), names));
    }
    plates.push_back(static_cast<int>(found - names.begin()));
  }
  return plates;
}

}  // namespace

TouchTables ReadTouchTables(const std::vector<std::filesystem::path>& files, const Project& project,
                            const std::vector<ContactFoot>* feet) {
  TouchTables tables;
  tables.setup = project.contact->setup;
  std::vector<TouchFile> read;
  Eigen::Index rows = 0;
  for (auto at = files.begin(); at != files.end(); ++at) {
    const std::filesystem::path& file = *at;
    if (std::find(files.begin(), at, file) != at) {
      throw InputError(file.string() + ": the file is given twice; its touches would count twice");
    }
    if (FileTypeOf(file) == std::filesystem::file_type::directory) {
      throw InputError(file.string() +
                       ": this is a folder; tables of touches (CSV) were expected, because the "
                       "project has contact");
    }
    read.push_back(ReadTouchFile(file, project));
    rows += read.back().postures.q.rows();
  }
  Touches& touches = tables.touches;
  touches.q.resize(rows, project.tree.coordinate_count());
  rows = 0;
  for (const TouchFile& file : read) {
    touches.q.middleRows(rows, file.postures.q.rows()) = file.postures.q;
    rows += file.postures.q.rows();
  }
  if (feet != nullptr) {
    tables.setup.feet = *feet;
  } else {
    PlaceFeet(project.tree, touches.q, project.contact->foot_placed, tables.setup);
  }
  std::map<std::pair<int, std::string>, int> sessions;
  for (std::size_t f = 0; f < read.size(); ++f) {
    const TouchFile& file = read[f];
    touches.files.push_back(file.postures.source);
    const std::vector<int> plates = PlatesOf(file, project, tables.setup);
    const bool by_file = project.contact->sessions.columns.empty();
    for (std::size_t i = 0; i < plates.size(); ++i) {
      const std::string key = by_file ? file.postures.source : file.sessions[i];
      const auto [session, is_new] =
          sessions.emplace(std::pair(plates[i], key), static_cast<int>(touches.sessions.size()));
      if (is_new) touches.sessions.push_back({plates[i], key});
      touches.touches.push_back(
          {plates[i], session->second, static_cast<int>(f), file.postures.line[i]});
    }
    for (std::string& warning : LimitWarnings(file.postures, project.tree)) {
      tables.warnings.push_back(std::move(warning));
    }
  }
  return tables;
}

}  // namespace elastocal
