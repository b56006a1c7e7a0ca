// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/joint_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// A quarter of an hour at 1 kHz; this bounds the memory that a file can take.
constexpr int kMostLogRows = 1000000;

using WrenchNames = std::array<std::string, 6>;

/// The columns of a force-torque sensor.
WrenchNames WrenchColumns(const ForceTorqueSensor& sensor) {
  const std::string& name = sensor.name;
  return {name + "_fx", name + "_fy", name + "_fz", name + "_tx", name + "_ty", name + "_tz"};
}

/// Which column of a joint log holds what.
struct JointColumns {
  int time = -1;
  std::vector<int> joints;     ///< of the tree, those with positions, in the order of these columns
  std::vector<int> positions;  ///< column of each of these
  std::vector<int> torques;    ///< column of each of these; -1 where there is none
  std::vector<int> sensors;    ///< of Project::force_torque_sensors, those with columns
  std::vector<int> wrenches;   ///< six columns of each of these: fx, ..., tz
};

/// Meaning of the column names: quantity 0 is the time, 1 + k the position and 1 + joints + k the
/// torque of joint k; the six of each force-torque sensor follow.
ColumnRoles LogRoles(const Table& table, const Project& project) {
  const std::vector<Joint>& joints = project.tree.joints;
  const auto count = static_cast<int>(joints.size());
  const auto role = [&](int k, int quantity) { return joints[k].mimic ? kPassedOver : quantity; };
  ColumnRoles roles;
  roles[project.recording.time] = 0;
  for (int k = 0; k < count; ++k) {
    AddRole(project, JointColumn(project, joints[k].name), role(k, 1 + k), roles);
  }
  // A name that is also that of a joint means this joint.
  roles.emplace("time", 0);
  const auto in_seconds = [&](const std::string& column) {
    return column == project.recording.time || column == "time";
  };
  if (std::ranges::none_of(table.header(), in_seconds)) {
    for (const std::string& column : table.header()) {
      if (TimeUnitOfName(column)) roles.emplace(column, 0);
    }
  }
  for (int k = 0; k < count; ++k) {
    const std::string column = JointColumn(project, joints[k].name);
    roles.emplace(column + "_position", role(k, 1 + k));
    roles.emplace(column + "_torque", role(k, 1 + count + k));
    roles.emplace(column + "_effort", role(k, 1 + count + k));
  }
  int quantity = 1 + 2 * count;
  for (const ForceTorqueSensor& sensor : project.force_torque_sensors) {
    for (const std::string& column : WrenchColumns(sensor)) roles.emplace(column, quantity++);
  }
  for (const std::string& column : table.header()) {
    const std::string plain = PlainColumnName(column);
    if (plain.empty() || plain.ends_with("_velocity")) roles.emplace(column, kPassedOver);
    const auto known = roles.find(plain);
    if (known != roles.end()) roles.emplace(column, known->second);
  }
  return roles;
}

JointColumns FindJointColumns(const Table& table, const Project& project) {
  const std::vector<Joint>& joints = project.tree.joints;
  const auto& sensors = project.force_torque_sensors;
  const std::vector<int> found =
      FindRecordingColumns(table, LogRoles(table, project),
                           1 + 2 * joints.size() + WrenchNames().size() * sensors.size(), project);
  const int* const positions = found.data() + 1;
  const int* const torques = positions + joints.size();
  const int* wrench = torques + joints.size();
  JointColumns columns;
  columns.time = found[0];
  if (columns.time < 0) {
    table.Fail("there is no column of the time in s; expected " + Quote(project.recording.time) +
               " or 'time' (or 'time_ns' and the like: the unit at the end)");
  }
  std::map<int, int> joint_of_column;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (positions[k] >= 0) {
      joint_of_column[positions[k]] = static_cast<int>(k);
    } else if (torques[k] >= 0) {
      table.Fail("the column " + Quote(table.header()[torques[k]]) + " has torques of joint " +
                 Quote(joints[k].name) + ", whose positions are missing");
    }
  }
  for (const auto& [column, joint] : joint_of_column) {
    columns.joints.push_back(joint);
    columns.positions.push_back(column);
    columns.torques.push_back(torques[joint]);
  }
  for (std::size_t i = 0; i < sensors.size(); ++i, wrench += 6) {
    const std::string owner = "force-torque sensor " + Quote(sensors[i].name);
    if (!HasGroup(table, {wrench, 6}, WrenchColumns(sensors[i]), owner)) continue;
    columns.sensors.push_back(static_cast<int>(i));
    columns.wrenches.insert(columns.wrenches.end(), wrench, wrench + 6);
  }
  if (columns.joints.empty()) {
    table.Fail("there is no column of any joint; expected the names of the joints");
  }
  return columns;
}

/// Rows stand below the first one line by line.
std::string RowPlace(const std::string& source, int first_line, Eigen::Index row) {
  return Place(source, first_line + static_cast<int>(row));
}

/// A joint has a torque sensor or it has none.
void CheckTorques(const Eigen::Ref<const Eigen::VectorXd>& torques, const std::string& column,
                  const std::string& source, int first_line) {
  const Eigen::Index missing = torques.array().isNaN().count();
  if (missing == 0 || missing == torques.size()) return;
  Eigen::Index row = 0;
  while (!std::isnan(torques[row])) ++row;
  throw InputError(RowPlace(source, first_line, row) + "column " + Quote(column) +
                   ": found no torque; a finite number was expected, or no torque in any row");
}

/// Reads the numbers of all rows: time, positions, torques and wrenches of the log. Rows without
/// any position at the beginning are passed over, because loggers write them until the robot
/// answers. Returns the line of the first sample.
int ReadNumbers(const JointColumns& columns, const std::string& time_unit, Table& table,
                JointLog& log) {
  std::vector<double> time, positions, torques, wrenches;
  int first_line = 0;
  while (table.Next()) {
    if (time.empty()) {
      first_line = table.line();
      if (std::all_of(columns.positions.begin(), columns.positions.end(),
                      [&](int column) { return IsGap(table.Cell(column)); })) {
        continue;
      }
    }
    if (table.row_count() > kMostLogRows) {
      table.Fail("more than " + std::to_string(kMostLogRows) + " rows");
    }
    AppendTime(table, columns.time, time);
    for (int column : columns.positions) positions.push_back(table.Number(column));
    for (int column : columns.torques) {
      // Drivers log NaN for joints without a sensor.
      const bool gap = column < 0 || IsGap(table.Cell(column));
      torques.push_back(gap ? kNaN : table.Number(column));
    }
    for (int column : columns.wrenches) wrenches.push_back(table.Number(column));
  }
  const std::size_t rows = time.size();
  if (rows == 0) {
    throw InputError(table.source() + (table.row_count() == 0
                                           ? ": no row below the header"
                                           : ": no row below the header has a position"));
  }
  ToSeconds(TimeUnitOfName(table.header()[columns.time]).value_or(""), time_unit, table.source(),
            time);
  log.time_s = StackRows(time, rows);
  log.positions = StackRows(positions, rows);
  log.torques = StackRows(torques, rows);
  log.wrenches = StackRows(wrenches, rows);
  return first_line;
}

/// The log of joints, or of motors if the project names these (WithMotors).
JointLog ReadColumns(Table& table, const Project& project, const std::string& time_unit) {
  const std::string& source = table.source();
  const JointColumns columns = FindJointColumns(table, project);
  JointLog log;
  log.source = source;
  const int first_line = ReadNumbers(columns, time_unit, table, log);
  for (int sensor : columns.sensors) {
    log.wrench_sensors.push_back(project.force_torque_sensors[sensor]);
  }
  std::vector<const Joint*> joints;
  for (std::size_t i = 0; i < columns.joints.size(); ++i) {
    const Joint& joint = project.tree.joints[columns.joints[i]];
    const auto column = static_cast<Eigen::Index>(i);
    log.names.push_back(joint.name);
    joints.push_back(&joint);
    if (columns.torques[i] < 0) continue;
    auto torques = log.torques.col(column);
    if (std::ranges::find(project.torque_sensors, columns.joints[i]) !=
        project.torque_sensors.end()) {
      CheckTorques(torques, table.header()[columns.torques[i]], source, first_line);
    } else if (torques.array().isNaN().any()) {
      torques.setConstant(kNaN);  // nobody uses it, as in logs of other formats (TakeTorques)
    }
  }
  CheckUnits(joints, log.positions,
             [&](Eigen::Index row) { return RowPlace(source, first_line, row); });
  return log;
}

}  // namespace

JointLog ReadJointLog(const std::filesystem::path& file, const Project& project,
                      const std::string& time_unit) {
  std::istringstream stream = OpenTable(file);
  return ReadJointLog(stream, file.string(), project, time_unit);
}

JointLog ReadJointLog(std::istream& stream, const std::string& source, const Project& project,
                      const std::string& time_unit) {
  Table table(stream, source);
  JointLog log = ReadColumns(table, WithMotors(project, table.header(), source), time_unit);
  MotorsToJoints(project.tree, log);
  return log;
}

void WriteJointLog(const std::filesystem::path& file, const JointLog& log) {
  WriteFile(file, FormatJointLog(log));
}

std::string FormatJointLog(const JointLog& log) {
  std::vector<Eigen::Index> with_torque;
  TableWriter table;
  table.Add("t");
  for (const std::string& name : log.names) table.Add(name);
  for (Eigen::Index i = 0; i < log.torques.cols(); ++i) {
    if (log.torques.col(i).array().isNaN().all()) continue;
    with_torque.push_back(i);
    table.Add(log.names[static_cast<std::size_t>(i)] + "_torque");
  }
  for (const ForceTorqueSensor& sensor : log.wrench_sensors) {
    for (const std::string& column : WrenchColumns(sensor)) table.Add(column);
  }
  table.EndRow();
  for (Eigen::Index row = 0; row < log.time_s.size(); ++row) {
    table.Add(log.time_s[row]);
    for (double position : log.positions.row(row)) table.Add(position);
    for (Eigen::Index i : with_torque) table.Add(log.torques(row, i));
    for (Eigen::Index i = 0; i < log.wrenches.cols(); ++i) table.Add(log.wrenches(row, i));
    table.EndRow();
  }
  return table.text();
}

}  // namespace elastocal
