// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/posture_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <string_view>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/marker_units.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// More are no static postures but a motion; and they bound the memory that a file can take.
constexpr int kMostPostures = 100000;

/// Which column of a posture table holds what; -1 where there is none.
struct PostureColumns {
  int time = -1;
  std::vector<int> coordinates;                    ///< by coordinate of the tree
  std::vector<int> markers;                        ///< of the project, those with columns
  std::vector<std::array<int, 3>> marker_columns;  ///< x, y, z of each of these
};

/// Throws InputError for a joint that moves a recorded marker and has neither a column nor a
/// position in the project.
void CheckMovingJoints(const Table& table, const Project& project, const PostureColumns& columns) {
  const RobotTree& tree = project.tree;
  for (int m : columns.markers) {
    const Marker& marker = project.markers[m];
    for (int k : JointsToBody(tree, tree.links[marker.link].body)) {
      const int coordinate = tree.joints[k].coordinate;
      const Joint& joint = JointOfCoordinate(tree, coordinate);
      if (columns.coordinates[coordinate] >= 0) continue;
      if (project.recording.not_recorded.contains(joint.name)) continue;
      table.Fail("the column " + Quote(JointColumn(project, joint.name)) + " of joint " +
                 Quote(joint.name) + ", which moves marker " + Quote(marker.name) + ", is missing" +
                 OrItsMotors(tree, tree.coordinate_joint[coordinate]) +
                 "; a joint that stood still is given in recording." +
                 (joint.type == JointType::kRevolute ? "not_recorded_deg" : "not_recorded_mm") +
                 " of " + project.file.string());
    }
  }
}

/// Throws InputError for a joint log: a table whose columns are only a time and quantities of
/// joints, at least one of which only logs have.
void RefuseJointLog(const Table& table, const Project& project) {
  constexpr std::array<std::string_view, 4> kOfLogs = {"_torque", "_effort", "_velocity",
                                                       "_position"};
  std::set<std::string, std::less<>> joints;
  for (const Joint& joint : project.tree.joints) {
    joints.insert({joint.name, JointColumn(project, joint.name)});
  }
  bool timed = false, logged = false;
  for (const std::string& column : table.header()) {
    const std::string plain = PlainColumnName(column);
    if (plain.empty()) continue;  // column of a topic's header, no quantity of a joint
    if (plain == project.recording.time || TimeUnitOfName(plain)) {
      timed = true;
    } else if (const auto ending = std::ranges::find_if(
                   kOfLogs, [&](std::string_view end) { return plain.ends_with(end); });
               ending != kOfLogs.end() &&
               joints.contains(plain.substr(0, plain.size() - ending->size()))) {
      logged = true;
    } else if (!joints.contains(plain)) {
      return;
    }
  }
  if (!timed || !logged) return;
  table.Fail(
      "this is a joint log: its columns are the time and quantities of joints, none of markers; it "
      "needs a folder with experiment.yaml, which names it and the file of the markers "
      "(docs/formats.md, Recording folder); a posture table was expected");
}

PostureColumns FindPostureColumns(const Table& table, const Project& project) {
  RefuseJointLog(table, project);
  const RobotTree& tree = project.tree;
  const int coordinates = tree.coordinate_count();
  const int first_marker = 1 + coordinates;
  int quantities = 0;
  ColumnRoles roles;
  AddRole(project, project.recording.time, quantities++, roles);
  for (int c = 0; c < coordinates; ++c) {
    AddRole(project, JointColumn(project, JointOfCoordinate(tree, c).name), quantities++, roles);
  }
  for (const Marker& marker : project.markers) {
    for (const std::string& column : MarkerColumns(project, marker.name)) {
      AddRole(project, column, quantities++, roles);
    }
  }
  // Joints that follow others need not be read.
  for (const Joint& joint : tree.joints) {
    if (joint.mimic) roles.emplace(joint.name, kPassedOver);
  }
  const std::vector<int> found =
      FindRecordingColumns(table, std::move(roles), static_cast<std::size_t>(quantities), project);

  PostureColumns columns;
  columns.time = found[0];
  columns.coordinates.assign(found.begin() + 1, found.begin() + first_marker);
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    const std::string& name = project.markers[m].name;
    std::array<int, 3> xyz;
    std::copy_n(found.begin() + first_marker + 3 * static_cast<std::ptrdiff_t>(m), 3, xyz.begin());
    if (!HasGroup(table, xyz, MarkerColumns(project, name), "marker " + Quote(name))) continue;
    columns.markers.push_back(static_cast<int>(m));
    columns.marker_columns.push_back(xyz);
  }
  if (columns.markers.empty()) {
    const std::string& first = project.markers[0].name;
    table.Fail("there is no column of any marker; expected " +
               Quote(MarkerColumns(project, first)[0]) + " of marker " + Quote(first) +
               " or others");
  }
  CheckMovingJoints(table, project, columns);
  return columns;
}

/// Reads the numbers of all rows: time, q, markers and line of the recording.
void ReadPostures(const Project& project, const PostureColumns& columns, Table& table,
                  Recording& recording) {
  const auto& given = project.recording.not_recorded;
  std::vector<double> elsewhere;  // positions of joints without a column
  for (int c = 0; c < project.tree.coordinate_count(); ++c) {
    const auto position = given.find(JointOfCoordinate(project.tree, c).name);
    elsewhere.push_back(position == given.end() ? 0.0 : position->second);
  }
  std::vector<double> time, q, markers;
  while (table.Next()) {
    if (table.row_count() > kMostPostures) {
      table.Fail("more than " + std::to_string(kMostPostures) +
                 " rows; one for each static posture expected");
    }
    recording.line.push_back(table.line());
    if (columns.time >= 0) time.push_back(table.Number(columns.time));
    for (std::size_t c = 0; c < elsewhere.size(); ++c) {
      const int column = columns.coordinates[c];
      q.push_back(column < 0 ? elsewhere[c] : table.Number(column));
    }
    for (const std::array<int, 3>& xyz : columns.marker_columns) {
      // All three cells empty or NaN: not seen. Only some: something went wrong, and Number says
      // where.
      const bool seen = std::any_of(xyz.begin(), xyz.end(),
                                    [&](int column) { return !IsGap(table.Cell(column)); });
      for (int column : xyz) {
        markers.push_back(seen ? table.Number(column) : kNaN);
      }
    }
  }
  const std::size_t rows = recording.line.size();
  if (rows == 0) throw InputError(table.source() + ": no row below the header; postures expected");
  recording.q = StackRows(q, rows);
  recording.markers = StackRows(markers, rows);
  if (!time.empty()) recording.time_s = StackRows(time, rows);
}

/// Replaces positions of motors by those of the joints. `with_motors` is a project WithMotors.
void CloseLinkages(const Project& with_motors, const RobotTree& tree, Recording& recording) {
  for (const Linkage& linkage : tree.linkages) {
    const auto first = static_cast<std::size_t>(linkage.joints[0]);
    if (with_motors.tree.joints[first].name == tree.joints[first].name) continue;
    const std::vector<int> columns = CoordinatesOf(tree, linkage);
    const Eigen::MatrixXd motors = recording.q(Eigen::all, columns);
    const Eigen::Index failed = MotorsToJoints(tree, linkage, columns, recording.q);
    if (failed < 0) continue;
    throw InputError(Place(recording.source, recording.line[static_cast<std::size_t>(failed)]) +
                     CannotClose(tree, linkage, motors, failed));
  }
}

/// Takes positions of exactly 0 0 0 for markers that were not seen, as many programs write them. A
/// marker that is there in all postures is kept: it may define the cameras' frame.
void TakeZerosAsNotSeen(const PostureColumns& columns, const Project& project,
                        PostureTable& table) {
  Recording& recording = table.recording;
  for (std::size_t m = 0; m < columns.markers.size(); ++m) {
    auto positions = recording.markers.middleCols<3>(3 * static_cast<Eigen::Index>(m));
    std::vector<Eigen::Index> zeros;
    for (Eigen::Index i = 0; i < positions.rows(); ++i) {
      if (positions.row(i).isZero(0.0)) zeros.push_back(i);
    }
    const auto count = static_cast<Eigen::Index>(zeros.size());
    if (count == 0 || count == positions.rows()) continue;
    positions(zeros, Eigen::all).setConstant(kNaN);
    const auto first = static_cast<std::size_t>(zeros.front());
    table.warnings.push_back("marker " + project.markers[columns.markers[m]].name +
                             ": taken as not seen where it is at exactly 0 0 0 (" +
                             std::to_string(count) + " postures, the first on line " +
                             std::to_string(recording.line[first]) + ")");
  }
}

/// Names what was recorded. A marker that was never seen counts as not recorded.
void NameMarkers(const PostureColumns& columns, const Project& project, PostureTable& table) {
  Recording& recording = table.recording;
  std::vector<int> kept;
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    const auto found =
        std::find(columns.markers.begin(), columns.markers.end(), static_cast<int>(m));
    const auto column = 3 * (found - columns.markers.begin());
    const bool has_columns = found != columns.markers.end();
    if (!has_columns || recording.markers.col(column).array().isNaN().all()) {
      table.markers_not_recorded.push_back(project.markers[m].name);
      if (has_columns) {
        table.warnings.push_back("marker " + project.markers[m].name +
                                 " was never seen and is left out");
      }
      continue;
    }
    recording.marker_names.push_back(project.markers[m].name);
    for (int axis = 0; axis < 3; ++axis) kept.push_back(static_cast<int>(column) + axis);
  }
  if (kept.empty()) throw InputError(recording.source + ": no marker was seen in any posture");
  recording.markers = recording.markers(Eigen::all, kept).eval();
}

}  // namespace

PostureTable ReadPostureTable(const std::filesystem::path& file, const Project& project) {
  RefuseRecording(file);
  std::istringstream stream = OpenTable(file);
  return ReadPostureTable(stream, file.string(), project);
}

PostureTable ReadPostureTable(std::istream& stream, const std::string& source,
                              const Project& project) {
  Table table(stream, source);
  const Project with_motors = WithMotors(project, table.header(), source);
  const PostureColumns columns = FindPostureColumns(table, with_motors);
  PostureTable result;
  Recording& recording = result.recording;
  recording.source = source;
  recording.free_root = project.recording.free_root;
  recording.gravity = project.recording.gravity;
  ReadPostures(with_motors, columns, table, recording);
  CloseLinkages(with_motors, project.tree, recording);
  TakeZerosAsNotSeen(columns, project, result);
  NameMarkers(columns, project, result);
  for (int c = 0; c < project.tree.coordinate_count(); ++c) {
    if (columns.coordinates[c] >= 0) continue;
    recording.joints_not_recorded.push_back(JointOfCoordinate(project.tree, c).name);
  }
  if (const auto other =
          FindOtherUnit(recording.markers, recording.marker_names, project.markers)) {
    throw InputError(source + ": " + Describe(*other));
  }
  CheckPlausible(recording, project.tree);
  for (std::string& warning : LimitWarnings(recording, project.tree)) {
    result.warnings.push_back(std::move(warning));
  }
  const std::string repetition = RepetitionWarning(recording);
  if (!repetition.empty()) result.warnings.push_back(repetition);
  return result;
}

void WritePostureTable(const std::filesystem::path& file, const Recording& recording,
                       const RobotTree& tree) {
  Project project;  // without columns of its own
  project.tree = tree;
  WritePostureTable(file, recording, project);
}

void WritePostureTable(const std::filesystem::path& file, const Recording& recording,
                       const Project& project) {
  const RobotTree& tree = project.tree;
  Eigen::MatrixXd q = recording.q;
  const RobotTree named = JointsToMotors(tree, recording.joints_not_recorded, q);
  const bool timed = recording.time_s.size() > 0;
  const auto& absent = recording.joints_not_recorded;
  std::vector<int> coordinates;  // that the recording holds
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const bool recorded =
        std::find(absent.begin(), absent.end(), JointOfCoordinate(named, c).name) == absent.end();
    if (recorded) coordinates.push_back(c);
  }
  TableWriter table;
  if (timed) table.Add(project.recording.time);
  for (const std::string& marker : recording.marker_names) {
    for (const std::string& column : MarkerColumns(project, marker)) table.Add(column);
  }
  for (int c : coordinates) table.Add(JointColumn(project, JointOfCoordinate(named, c).name));
  table.EndRow();
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (timed) table.Add(recording.time_s[i]);
    for (double position : recording.markers.row(i)) table.Add(position);
    for (int c : coordinates) table.Add(q(i, c));
    table.EndRow();
  }
  WriteFile(file, table.text());
}

}  // namespace elastocal
