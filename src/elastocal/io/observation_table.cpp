// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/observation_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "elastocal/io/detections.hpp"
#include "elastocal/io/known_names.hpp"
#include "elastocal/io/measured_cells.hpp"
#include "elastocal/io/observation_columns.hpp"
#include "elastocal/io/observation_sessions.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/repeated_rows.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/standing_robot.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kMostRows = 20000;

/// Measurement of an instrument in one row.
struct MeasuredRow {
  int row = 0, instrument = 0;
  Eigen::VectorXd measured;
};

/// One table as it was read.
struct ObservationFile {
  Recording postures;                 // no markers
  std::vector<std::string> sessions;  // by row
  std::vector<std::string> warnings;
  std::vector<std::string> plates;  // by row; empty without a column of plates
  std::vector<std::string> frames;  // names of images by row; empty without a column
  std::vector<MeasuredRow> measured;
};

ObservationFile ReadObservationFile(const std::filesystem::path& file, const Project& project,
                                    RepeatedRows& repeated) {
  std::istringstream stream = OpenTable(file);
  Table table(stream, file.string());
  const ObservationColumns columns = FindObservationColumns(table, project);
  const RobotTree& tree = project.tree;
  const auto& instruments = project.contact->setup.instruments;
  ObservationFile result;
  Recording& postures = result.postures;
  postures.source = file.string();
  SessionReader sessions(table, columns, project);
  std::vector<double> q;
  while (table.Next()) {
    if (table.row_count() > kMostRows) table.Fail("more than 20000 rows; one a posture expected");
    repeated.Take(table);
    const int row = static_cast<int>(postures.line.size());
    postures.line.push_back(table.line());
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const auto given = project.recording.not_recorded.find(JointOfCoordinate(tree, c).name);
      const double elsewhere = given == project.recording.not_recorded.end() ? 0.0 : given->second;
      q.push_back(columns.coordinates[c] < 0 ? elsewhere : table.Number(columns.coordinates[c]));
    }
    sessions.Take();
    if (columns.plate >= 0) result.plates.emplace_back(table.Cell(columns.plate));
    if (columns.frame >= 0) result.frames.emplace_back(table.Cell(columns.frame));
    for (std::size_t i = 0; i < instruments.size(); ++i) {
      auto measured = ReadMeasured(table, *instruments[i], columns.instruments[i]);
      if (measured) {
        result.measured.push_back({row, static_cast<int>(i), std::move(*measured)});
      }
    }
  }
  if (postures.line.empty()) {
    throw InputError(table.source() + ": no row below the header; postures expected");
  }
  postures.q = StackRows(q, postures.line.size());
  result.sessions = sessions.Sessions(postures.q, result.warnings);
  postures.markers.resize(postures.q.rows(), 0);
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    if (columns.coordinates[c] < 0) {
      postures.joints_not_recorded.push_back(JointOfCoordinate(tree, c).name);
    }
  }
  CheckPlausible(postures, tree);
  return result;
}

/// The plate that touches in each row, by the plate column; -1: none.
std::vector<int> NamedPlates(const ObservationFile& file, const ObservationSetup& setup) {
  std::vector<std::string> names;
  for (const ContactPlate& plate : setup.plates) names.push_back(plate.name);
  std::vector<int> plates;
  for (std::size_t i = 0; i < file.plates.size(); ++i) {
    if (IsGap(file.plates[i])) {
      plates.push_back(-1);
      continue;
    }
    const auto found = std::find(names.begin(), names.end(), file.plates[i]);
    if (found == names.end()) {
      throw InputError(Place(file.postures.source, file.postures.line[i]) + "there is no plate " +
                       Quote(file.plates[i]) + Known(file.plates[i], names));
    }
    plates.push_back(static_cast<int>(found - names.begin()));
  }
  return plates;
}

/// The plate that touches in each row: by the plate column or, if the project has none, the plate
/// that lies flattest in rows in which no instrument shows anything; -1: none.
std::vector<int> PlatesOf(const ObservationFile& file, const Project& project,
                          const ObservationSetup& setup) {
  if (!file.plates.empty()) {
    std::vector<int> named = NamedPlates(file, setup);
    CheckNamedPlates(project.tree, setup, file.postures.q, named, file.postures.source);
    return named;
  }
  std::vector<int> plates(file.postures.line.size(), -1);
  if (setup.plates.empty() || !project.contact->plate_column.empty()) return plates;
  std::vector<char> shown(plates.size(), 0);
  for (const MeasuredRow& of : file.measured) shown[static_cast<std::size_t>(of.row)] = 1;
  for (std::size_t i = 0; i < file.frames.size(); ++i) {
    if (!IsGap(file.frames[i])) shown[i] = 1;
  }
  std::vector<int> touches;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    if (shown[i] == 0) touches.push_back(static_cast<int>(i));
  }
  if (touches.empty()) return plates;
  const std::vector<int> found = FindTouchingPlates(
      project.tree, setup, file.postures.q(touches, Eigen::all), file.postures.source);
  for (std::size_t k = 0; k < found.size(); ++k) plates[touches[k]] = found[k];
  return plates;
}

/// Adds observations with the effects of their sessions.
class ObservationCollector {
 public:
  /// `set_ups_vary`: trackers and wires were set up more than once.
  ObservationCollector(ObservationTables& tables, bool set_ups_vary)
      : tables_(tables), set_ups_vary_(set_ups_vary) {}

  /// `session`: of tables and walls; `set_up`: of trackers and wires.
  void Add(Observation observation, const std::string& session, const std::string& set_up) {
    const Instrument& instrument =
        *tables_.setup.instruments[static_cast<std::size_t>(observation.instrument)];
    const int quantity =
        instrument.varying < 0 ? -1 : instrument.quantities[Size(instrument.varying)];
    const bool by_set_up = quantity >= 0 && tables_.setup.quantities[Size(quantity)].set_up_anew;
    if (quantity >= 0 && (!by_set_up || set_ups_vary_)) {
      const std::string& of = by_set_up ? set_up : session;
      std::vector<SessionEffect>& effects = tables_.observations.effects;
      const auto [effect, is_new] =
          sessions_.emplace(std::pair(quantity, of), static_cast<int>(effects.size()));
      if (is_new) effects.push_back({quantity, of});
      observation.effects = {effect->second};
    }
    tables_.observations.all.push_back(std::move(observation));
  }

 private:
  ObservationTables& tables_;
  bool set_ups_vary_;
  std::map<std::pair<int, std::string>, int> sessions_;
};

/// For each row, the name of the set-up of trackers and wires. It is the file, because nobody moves
/// them when the robot is started anew; if the project tells sessions by columns of texts, it is
/// the session.
std::vector<std::string> SetUps(const ObservationFile& file, const Project& project) {
  const SessionRule& rule = project.contact->sessions;
  if (!rule.columns.empty() && rule.quantum == 0.0) return file.sessions;
  return std::vector<std::string>(file.sessions.size(), file.postures.source);
}

bool SetUpsVary(const std::vector<ObservationFile>& files, const Project& project) {
  std::set<std::string> sessions;
  for (const ObservationFile& file : files) {
    for (const std::string& session : SetUps(file, project)) sessions.insert(session);
  }
  return sessions.size() > 1;
}

void AddFile(const ObservationFile& file, const Project& project, int index,
             ObservationCollector& collector, ObservationTables& tables) {
  std::vector<PosturePlace>& postures = tables.observations.postures;
  const int first = static_cast<int>(postures.size());
  for (int line : file.postures.line) postures.push_back({index, line});
  const std::vector<int> plates = PlatesOf(file, project, tables.setup);
  const std::vector<std::string> set_ups = SetUps(file, project);
  const auto add = [&](Observation observation, int row) {
    collector.Add(std::move(observation), file.sessions[Size(row)], set_ups[Size(row)]);
  };
  for (int row = 0; row < static_cast<int>(plates.size()); ++row) {
    if (plates[row] >= 0) add({first + row, plates[row], {}, {}}, row);
  }
  for (const MeasuredRow& of : file.measured) {
    add({first + of.row, of.instrument, of.measured, {}}, of.row);
  }
}

/// The posture of each frame.
std::map<std::string, int> PosturesOfFrames(const std::vector<ObservationFile>& files) {
  std::map<std::string, int> postures;
  int first = 0;
  for (const ObservationFile& file : files) {
    for (std::size_t i = 0; i < file.frames.size(); ++i) {
      if (IsGap(file.frames[i])) continue;
      if (!postures.emplace(file.frames[i], first + static_cast<int>(i)).second) {
        throw InputError(Place(file.postures.source, file.postures.line[i]) + "a second row has " +
                         "frame " + Quote(file.frames[i]));
      }
    }
    first += static_cast<int>(file.postures.line.size());
  }
  return postures;
}

void AddDetections(const std::vector<std::filesystem::path>& files, const Project& project,
                   const std::map<std::string, int>& postures, ObservationTables& tables) {
  for (const std::filesystem::path& file : files) {
    for (Detection& detection : ReadDetections(file, project)) {
      const auto found = postures.find(detection.frame);
      if (found == postures.end()) {
        throw InputError(Place(file.string(), detection.line) + "no row of a table of " +
                         "observations has frame " + Quote(detection.frame) +
                         " in its column 'frame'");
      }
      tables.observations.all.push_back(
          {found->second, detection.instrument, std::move(detection.pixels), {}});
    }
  }
}

std::vector<std::string> SilentInstruments(const ObservationTables& tables) {
  std::vector<std::string> warnings;
  for (std::size_t i = tables.setup.plates.size(); i < tables.setup.instruments.size(); ++i) {
    const std::vector<Observation>& all = tables.observations.all;
    if (std::any_of(all.begin(), all.end(),
                    [&](const Observation& of) { return of.instrument == static_cast<int>(i); })) {
      continue;
    }
    warnings.push_back(Quote(tables.setup.instruments[i]->name) +
                       " shows nothing in these tables; its quantities stay as the project has "
                       "them");
  }
  return warnings;
}

/// Whether no table has the column that names plates, although the project names one. Other
/// instruments could hide that no touch is read.
bool PlatesAreNamedNowhere(const std::vector<ObservationFile>& files, const Project& project) {
  return !project.contact->setup.plates.empty() && !project.contact->plate_column.empty() &&
         std::all_of(files.begin(), files.end(),
                     [](const ObservationFile& file) { return file.plates.empty(); });
}

}  // namespace

std::vector<std::filesystem::path> ObservationFiles(
    const std::vector<std::filesystem::path>& recordings) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& recording : recordings) {
    if (FileTypeOf(recording) != std::filesystem::file_type::directory) {
      files.push_back(recording);
      continue;
    }
    const std::filesystem::path table = recording / "observations.csv";
    const std::filesystem::path corners = recording / "corners.csv";
    if (FileTypeOf(table) == std::filesystem::file_type::not_found) {
      throw InputError(recording.string() +
                       ": this is a folder without observations.csv; tables of observations (CSV) "
                       "were expected, because the project has contact or instruments");
    }
    files.push_back(table);
    if (FileTypeOf(corners) != std::filesystem::file_type::not_found) files.push_back(corners);
  }
  return files;
}

namespace {

/// The files of a recording by their kind.
struct ReadFiles {
  std::vector<ObservationFile> tables;
  std::vector<std::filesystem::path> detections;  ///< tables of corners, not read yet
  RepeatedRows repeated;
};

ReadFiles ReadByKind(const std::vector<std::filesystem::path>& files, const Project& project) {
  if (files.empty()) throw InputError("no recording; one or more were expected");
  ReadFiles read;
  for (auto at = files.begin(); at != files.end(); ++at) {
    const std::filesystem::path& file = *at;
    if (std::find(files.begin(), at, file) != at) {
      throw InputError(file.string() + ": the file is given twice; its rows would count twice");
    }
    if (IsDetectionTable(file)) {
      read.detections.push_back(file);
    } else {
      read.tables.push_back(ReadObservationFile(file, project, read.repeated));
    }
  }
  if (read.tables.empty()) {
    throw InputError(files.front().string() +
                     ": this is a table of corners; a table of observations with the positions of "
                     "the joints and a column 'frame' was expected beside it");
  }
  return read;
}

/// The postures of all tables, one below the other.
Eigen::MatrixXd PosturesOf(const std::vector<ObservationFile>& tables, int coordinates) {
  Eigen::Index rows = 0;
  for (const ObservationFile& file : tables) rows += file.postures.q.rows();
  Eigen::MatrixXd q(rows, coordinates);
  rows = 0;
  for (const ObservationFile& file : tables) {
    q.middleRows(rows, file.postures.q.rows()) = file.postures.q;
    rows += file.postures.q.rows();
  }
  return q;
}

}  // namespace

ObservationTables ReadObservationTables(const std::vector<std::filesystem::path>& recordings,
                                        const Project& project,
                                        const std::vector<ContactFoot>* feet) {
  ReadFiles read_files = ReadByKind(ObservationFiles(recordings), project);
  std::vector<ObservationFile>& read = read_files.tables;
  ObservationTables tables;
  tables.setup = project.contact->setup;
  Observations& observations = tables.observations;
  observations.q = PosturesOf(read, project.tree.coordinate_count());
  if (feet != nullptr) {
    tables.setup.feet = *feet;
  } else if (!tables.setup.feet.empty()) {
    PlaceFeet(project.tree, observations.q, project.contact->foot_placed, tables.setup);
  }
  ObservationCollector collector(tables, SetUpsVary(read, project));
  for (std::size_t f = 0; f < read.size(); ++f) {
    observations.files.push_back(read[f].postures.source);
    AddFile(read[f], project, static_cast<int>(f), collector, tables);
    for (std::string& warning : LimitWarnings(read[f].postures, project.tree)) {
      tables.warnings.push_back(std::move(warning));
    }
    for (std::string& warning : read[f].warnings) tables.warnings.push_back(std::move(warning));
  }
  AddDetections(read_files.detections, project, PosturesOfFrames(read), tables);
  NoteApproach(observations);
  if (observations.all.empty()) {
    throw InputError(observations.files.front() +
                     ": in no row does an instrument show anything or a plate touch");
  }
  if (std::string warning = read_files.repeated.Warning(); !warning.empty()) {
    tables.warnings.push_back(std::move(warning));
  }
  if (PlatesAreNamedNowhere(read, project)) {
    tables.warnings.push_back("no table has the column " + Quote(project.contact->plate_column) +
                              " (contact.plate_column), which names the plate that touches: no "
                              "touch is read");
  }
  for (std::string& warning : SilentInstruments(tables)) {
    tables.warnings.push_back(std::move(warning));
  }
  return tables;
}

}  // namespace elastocal
