// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/recorded_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/named_postures.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/qtm_header.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// The one trajectory whose name is the label, or else ends with ":label"; -1 where there is none.
int FindLabel(const MarkerTrajectories& trajectories, const std::string& label) {
  int found = -1;
  for (std::size_t i = 0; i < trajectories.names.size(); ++i) {
    const std::string& name = trajectories.names[i];
    if (name == label) return static_cast<int>(i);
    if (!name.ends_with(":" + label)) continue;
    if (found >= 0) {
      throw InputError(trajectories.source + ": " +
                       Quote(trajectories.names[static_cast<std::size_t>(found)]) + " and " +
                       Quote(name) + " could both be the marker " + Quote(label) +
                       "; name one of them in recording.labels of the project");
    }
    found = static_cast<int>(i);
  }
  return found;
}

/// Throws InputError if another trajectory has the same name: readers call it NAME#2
/// (DistinctNames).
void RequireOne(const MarkerTrajectories& trajectories, const std::string& name) {
  if (std::ranges::find(trajectories.names, name + "#2") == trajectories.names.end()) return;
  throw InputError(trajectories.source + ": two trajectories have the label " + Quote(name) +
                   ", and nothing tells which of them is the marker; give one of them another "
                   "label");
}

void NameAsProject(const Project& project, MarkerTrajectories& trajectories) {
  std::vector<std::string> names = trajectories.names;
  for (const Marker& marker : project.markers) {
    const auto label = project.recording.labels.find(marker.name);
    const bool given = label != project.recording.labels.end();
    const int found = FindLabel(trajectories, given ? label->second : marker.name);
    if (found < 0) continue;
    RequireOne(trajectories, trajectories.names[static_cast<std::size_t>(found)]);
    // What has this name by itself is another marker then.
    const auto same = std::find(names.begin(), names.end(), marker.name);
    if (same != names.end() && same - names.begin() != found) *same += " (as recorded)";
    names[static_cast<std::size_t>(found)] = marker.name;
  }
  trajectories.names = std::move(names);
}

/// Six columns of a force-torque sensor; false where any is absent.
bool FindWrench(const std::map<std::string, Eigen::Index>& columns, const std::string& sensor,
                std::array<Eigen::Index, 6>& found) {
  constexpr std::array<const char*, 6> kEndings = {"_fx", "_fy", "_fz", "_tx", "_ty", "_tz"};
  for (std::size_t i = 0; i < kEndings.size(); ++i) {
    const auto column = columns.find(sensor + kEndings[i]);
    if (column == columns.end()) return false;
    found[i] = column->second;
  }
  return true;
}

/// Moves the wrenches from the columns of `from` to the log; they are then not in `columns`.
void TakeWrenches(const JointLog& from, const Project& project,
                  std::map<std::string, Eigen::Index>& columns, JointLog& log) {
  for (const ForceTorqueSensor& sensor : project.force_torque_sensors) {
    std::array<Eigen::Index, 6> found{};
    if (!FindWrench(columns, sensor.name, found)) continue;
    const Eigen::Index begin = log.wrenches.cols();
    log.wrench_sensors.push_back(sensor);
    log.wrenches.conservativeResize(from.sample_count(), begin + 6);
    for (std::size_t i = 0; i < found.size(); ++i) {
      log.wrenches.col(begin + static_cast<Eigen::Index>(i)) = from.positions.col(found[i]);
    }
    std::erase_if(columns, [&](const auto& column) {
      return std::find(found.begin(), found.end(), column.second) != found.end();
    });
  }
}

[[noreturn]] void FailUnknown(const JointLog& log, const std::string& name,
                              const std::vector<std::string>& known, const Project& project) {
  throw InputError(log.source + ": the joint " + Quote(name) + " is not known" +
                   DidYouMean(name.substr(0, 60), known) +
                   "; what is not to be read is listed in recording.ignore of " +
                   project.file.string() + ", joints with other names in recording.columns.joints");
}

/// Takes the torques of a joint, all or none; those of joints without a sensor are not used.
void TakeTorques(const Eigen::Ref<const Eigen::VectorXd>& torques, int joint,
                 const Project& project, JointLog& log) {
  const Eigen::Index missing = torques.array().isNaN().count();
  const auto& sensors = project.torque_sensors;
  if (missing == 0) {
    log.torques.col(log.torques.cols() - 1) = torques;
  } else if (missing < torques.size() &&
             std::find(sensors.begin(), sensors.end(), joint) != sensors.end()) {
    throw InputError(log.source + ": joint " + Quote(project.tree.joints[joint].name) + " has " +
                     std::to_string(missing) +
                     " samples without a torque; a torque in every sample was expected, or none");
  }
}

}  // namespace

MarkerFile ReadMarkerFile(const fs::path& file, const ReaderOptions& options,
                          const Project& project) {
  const ByteSource source = ByteSource::Open(file);
  MarkerFile markers;
  if (RecogniseRecording(source)) {
    RecordingFile read = ReadRecordingFile(source, options);
    if (!read.markers) {
      throw InputError(source.name() + " (" + read.format +
                       "): there are no markers in it: " + read.why_no_markers);
    }
    markers.trajectories = std::move(*read.markers);
    markers.up = read.up;
    markers.start_s = read.markers_start_s;
  } else {
    UnitOf("mm", options.unit, source.name());  // refuses another one
    markers.trajectories = ReadQtmTsv(file);
    markers.up_is_z = true;
  }
  NameAsProject(project, markers.trajectories);
  return markers;
}

namespace {

/// Whether a joint seems to turn by half a turn faster than any joint does. (A lost sample is often
/// 0.)
bool IsHalfTurn(double before, double after, double seconds) {
  constexpr double kNear = 0.1, kFastest = 50.0;  // rad, rad/s
  const double step = std::abs(after - before);
  return std::abs(step - std::numbers::pi) < kNear && step > kFastest * seconds && before != 0.0 &&
         after != 0.0;
}

/// Removes jumps by a whole turn between two samples of a revolute joint, as in a log that counts
/// from -pi to pi. No joint turns so fast.
void UnwrapTurns(const RobotTree& tree, JointLog& log) {
  constexpr double kLongestStep = 0.2;  // s
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (std::size_t k = 0; k < log.names.size(); ++k) {
    const auto joint = std::find_if(tree.joints.begin(), tree.joints.end(),
                                    [&](const Joint& one) { return one.name == log.names[k]; });
    if (joint == tree.joints.end() || joint->type == JointType::kPrismatic) continue;
    auto column = log.positions.col(static_cast<Eigen::Index>(k));
    double turns = 0.0, before = column[0];
    for (Eigen::Index i = 1; i < column.size(); ++i) {
      const double step = column[i] - before;
      if (IsHalfTurn(before, column[i], log.time_s[i] - log.time_s[i - 1])) {
        throw InputError(log.source + ": joint '" + log.names[k] +
                         "' jumps by half a turn between two samples at " +
                         std::to_string(log.time_s[i]) +
                         " s: does it count modulo half a turn? Positions that go on, or modulo a "
                         "whole turn, were expected");
      }
      before = column[i];
      const bool one_sample = log.time_s[i] - log.time_s[i - 1] < kLongestStep;
      if (one_sample && std::abs(step) > 0.5 * kTurn) turns -= std::round(step / kTurn);
      column[i] += kTurn * turns;
    }
  }
}

JointLog ReadAnyLog(const fs::path& file, const ReaderOptions& options, const Project& project) {
  const ByteSource source = ByteSource::Open(file);
  if (!RecogniseRecording(source)) return ReadJointLog(file, project, options.time_unit);
  const RecordingFile read = ReadRecordingFile(source, options);
  if (!read.joints) {
    throw InputError(source.name() + " (" + read.format +
                     "): there are no joint positions in it: " + read.why_no_joints);
  }
  return TakeJoints(*read.joints, project);
}

}  // namespace

JointLog ReadJointFile(const fs::path& file, const ReaderOptions& options, const Project& project) {
  JointLog log = ReadAnyLog(file, options, project);
  if (log.sample_count() > 0) UnwrapTurns(project.tree, log);
  return log;
}

namespace {

std::string HeadOf(const ByteSource& source) {
  std::string head(4096, '\0');
  head.resize(source.Read(0, head));
  return head;
}

/// Throws InputError where two columns have the same quantity, as two topics of one joint have.
void RequireDifferentNames(const Table& table, const std::vector<std::string>& names) {
  std::map<std::string, std::string> taken;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty() || table.CountsRows(static_cast<int>(i))) continue;
    const auto [first, is_new] = taken.emplace(names[i], table.header()[i]);
    if (is_new) continue;
    table.Fail(first->second == table.header()[i]
                   ? "the column " + Quote(first->second) + " comes twice"
                   : "the columns " + Quote(first->second) + " and " + Quote(table.header()[i]) +
                         " stand for the same (" + Quote(names[i]) + "); leave one of them out");
  }
}

/// A CSV with a column of the time, all of whose other columns are numbers of joints.
JointLog ReadPlainLog(const ByteSource& source, const std::string& time_unit) {
  SourceStream stream(source);
  Table table(stream, source.name());
  const std::vector<std::string>& header = table.header();
  const auto at = header.begin() + FindTime(header);
  if (at == header.end()) {
    table.Fail(
        "this is no recording of a known format, nor a joint log: there is no column 't' or "
        "'time'");
  }
  std::vector<std::string> names;
  std::ranges::transform(header, std::back_inserter(names), PlainColumnName);
  RequireDifferentNames(table, names);
  std::vector<double> time;
  std::map<std::string, std::vector<double>> columns;
  const auto is_empty = [&] {
    for (int i = 0; i < static_cast<int>(header.size()); ++i) {
      const bool counted = i == at - header.begin() || table.CountsRows(i);
      if (!counted && !IsGap(table.Cell(i))) return false;
    }
    return true;
  };
  while (table.Next()) {
    if (time.empty() && is_empty()) continue;  // as ReadJointLog does
    AppendTime(table, static_cast<int>(at - header.begin()), time);
    for (std::size_t i = 0; i < header.size(); ++i) {
      if (header.begin() + static_cast<std::ptrdiff_t>(i) == at) continue;
      const int column = static_cast<int>(i);
      if (table.CountsRows(column)) continue;
      const std::string& name = names[i];
      if (name.empty()) continue;
      const bool torque = name.ends_with("_torque") || name.ends_with("_effort");
      columns[name].push_back(torque && IsGap(table.Cell(column)) ? kNaN : table.Number(column));
    }
  }
  if (time.empty()) throw InputError(source.name() + ": no row below the header");
  ToSeconds(TimeUnitOfName(*at).value(), time_unit, source.name(), time);
  return JoinColumns(source.name(), time, std::move(columns));
}

}  // namespace

RecordingFile ReadAnyRecording(const fs::path& file, const ReaderOptions& options) {
  const ByteSource source = ByteSource::Open(file);
  if (RecogniseRecording(source)) return ReadRecordingFile(source, options);
  RecordingFile read;
  if (BeginsLikeQtmTsv(HeadOf(source))) {
    read.format = "Qualisys TSV";
    UnitOf("mm", options.unit, source.name());  // refuses another one
    read.markers = ReadQtmTsv(file, &read.notes);
    read.up = "z";
    read.why_no_joints = "a Qualisys TSV has no joint positions";
  } else if ((read.postures = ReadNamedPostures(source))) {
    read.format = "posture table (CSV)";
    read.why_no_markers = "a posture table has no frames";
    read.why_no_joints = "a posture table has no log";
  } else if ((read.postures =
                  ReadColumnsAsTheyAre(source, options.time_unit, read.why_no_joints))) {
    read.format = "table (CSV)";
    read.why_no_markers = "a table of no known names has no frames";
    read.notes.push_back(read.why_no_joints +
                         "; it is no joint log, and what the columns of a table of postures, "
                         "observations or corners are, "
                         "its project says");
  } else {
    read.format = "joint log (CSV)";
    read.joints = ReadPlainLog(source, options.time_unit);
    read.why_no_markers = "a joint log has joint positions only";
  }
  return read;
}

void RefuseRecording(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return;
  const ByteSource source = ByteSource::Open(file);
  std::optional<std::string> format = RecogniseRecording(source);
  if (!format && IsSurelyQtmTsv(HeadOf(source))) format = "Qualisys TSV";
  if (!format) return;
  throw InputError(file.string() + ": this is a recording over time (" + *format +
                   "); it needs a folder with experiment.yaml, which names it and the joint log "
                   "(docs/formats.md, Recording folder); a posture table was expected");
}

namespace {

/// The log of joints, or of motors if the project names these (WithMotors).
JointLog TakeColumns(const JointLog& from, const Project& project) {
  const std::vector<Joint>& joints = project.tree.joints;
  std::map<std::string, int> joint_of;
  std::vector<std::string> known;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    known.push_back(JointColumn(project, joints[k].name));
    joint_of.emplace(known.back(), static_cast<int>(k));
  }
  std::map<std::string, Eigen::Index> columns;
  for (std::size_t i = 0; i < from.names.size(); ++i) {
    columns.emplace(from.names[i], static_cast<Eigen::Index>(i));
  }
  for (const std::string& ignored : project.recording.ignore) columns.erase(ignored);
  JointLog log;
  log.source = from.source;
  log.time_s = from.time_s;
  TakeWrenches(from, project, columns, log);
  std::vector<const Joint*> logged;
  for (const auto& [name, column] : columns) {
    const auto joint = joint_of.find(name);
    if (joint == joint_of.end()) FailUnknown(from, name, known, project);
    if (joints[joint->second].mimic) continue;
    logged.push_back(&joints[joint->second]);
    const Eigen::Index to = log.positions.cols();
    log.names.push_back(joints[joint->second].name);
    log.positions.conservativeResize(from.sample_count(), to + 1);
    log.torques.conservativeResize(from.sample_count(), to + 1);
    log.positions.col(to) = from.positions.col(column);
    log.torques.col(to).setConstant(kNaN);
    TakeTorques(from.torques.col(column), joint->second, project, log);
  }
  if (log.names.empty()) throw InputError(log.source + ": it has no joint of the robot");
  if (log.sample_count() == 0) throw InputError(log.source + ": it has no sample");
  CheckUnits(logged, log.positions, [&](Eigen::Index sample) {
    return from.source + ": sample " + std::to_string(sample + 1) + ": ";
  });
  return log;
}

}  // namespace

JointLog TakeJoints(const JointLog& log, const Project& project) {
  JointLog joints = TakeColumns(log, WithMotors(project, log.names, log.source));
  MotorsToJoints(project.tree, joints);
  return joints;
}

}  // namespace elastocal
