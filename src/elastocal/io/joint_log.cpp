#include "elastocal/io/joint_log.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "elastocal/io/joint_columns.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/table_lines.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// A quarter of an hour at 1 kHz; this bounds the memory that a file can take.
constexpr std::size_t kMostRows = 1000000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool IsNan(const std::string& cell) { return cell == "nan" || cell == "NaN" || cell == "NAN"; }

/// The numbers of a log as they are read, row after row.
class LogReader {
 public:
  LogReader(const JointColumns& columns, const TableLines& lines, const std::string& source)
      : columns_(columns), lines_(lines), source_(source) {}

  void Add(const std::vector<std::string>& cells) {
    if (cells.size() != columns_.names.size()) {
      Fail("found " + std::to_string(cells.size()) + " cells; the header has " +
           std::to_string(columns_.names.size()));
    }
    if (time_.size() >= kMostRows) Fail("more than " + std::to_string(kMostRows) + " rows");
    const double time = Number(cells, columns_.time);
    if (!time_.empty() && !(time > time_.back())) {
      Fail("column " + Quote(columns_.names[columns_.time]) + ": found " + FormatNumber(time) +
           " after " + FormatNumber(time_.back()) + "; the time must increase from row to row");
    }
    time_.push_back(time);
    for (int column : columns_.positions) positions_.push_back(Number(cells, column));
    for (int column : columns_.torques) torques_.push_back(Torque(cells, column));
    for (const auto& sensor : columns_.wrenches) {
      for (int column : sensor) wrenches_.push_back(Number(cells, column));
    }
  }

  JointLog Finish(const Project& project) {
    if (time_.empty()) throw InputError(source_ + ": no row below the header");
    const auto rows = static_cast<Eigen::Index>(time_.size());
    const auto joints = static_cast<Eigen::Index>(columns_.joints.size());
    JointLog log;
    log.source = source_;
    log.time_s = Eigen::Map<const Eigen::VectorXd>(time_.data(), rows);
    log.positions = Eigen::Map<const RowMajor>(positions_.data(), rows, joints);
    log.torques = Eigen::Map<const RowMajor>(torques_.data(), rows, joints);
    log.wrenches = Eigen::Map<const RowMajor>(
        wrenches_.data(), rows, static_cast<Eigen::Index>(6 * columns_.wrenches.size()));
    for (int sensor : columns_.wrench_sensors) {
      log.wrench_sensors.push_back(project.force_torque_sensors[sensor]);
    }
    for (Eigen::Index i = 0; i < joints; ++i) {
      const Joint& joint = project.tree.joints[columns_.joints[i]];
      log.names.push_back(joint.name);
      CheckRadians(joint, log.positions.col(i), [&](Eigen::Index row) { return PlaceOf(row); });
      CheckTorques(log.torques.col(i), columns_.torques[i]);
    }
    return log;
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(source_, lines_.line()) + message);
  }

  /// Rows stand below the header line by line.
  std::string PlaceOf(Eigen::Index row) const { return Place(source_, 2 + static_cast<int>(row)); }

  double Number(const std::vector<std::string>& cells, int column) const {
    return CellNumber(cells[column], columns_.names[column], source_, lines_.line());
  }

  /// Drivers log NaN for joints without a sensor.
  double Torque(const std::vector<std::string>& cells, int column) const {
    if (column < 0 || cells[column].empty() || IsNan(cells[column])) return kNaN;
    return Number(cells, column);
  }

  void CheckTorques(const Eigen::Ref<const Eigen::VectorXd>& torques, int column) const {
    const Eigen::Index missing = torques.array().isNaN().count();
    if (missing == 0 || missing == torques.size()) return;
    Eigen::Index row = 0;
    while (!std::isnan(torques[row])) ++row;
    throw InputError(PlaceOf(row) + "column " + Quote(columns_.names[column]) +
                     ": found no torque; a finite number was expected, or no torque in any row");
  }

  const JointColumns& columns_;
  const TableLines& lines_;
  const std::string& source_;
  std::vector<double> time_, positions_, torques_, wrenches_;
};

}  // namespace

JointLog ReadJointLog(const std::filesystem::path& file, const Project& project) {
  std::ifstream stream = OpenTable(file);
  return ReadJointLog(stream, file.string(), project);
}

JointLog ReadJointLog(std::istream& stream, const std::string& source, const Project& project) {
  TableLines lines(stream, source);
  std::vector<std::string> cells;
  if (!lines.Next(cells)) throw InputError(source + ": is empty; a header row was expected");
  const JointColumns columns = FindJointColumns(cells, Place(source, lines.line()), project);
  LogReader reader(columns, lines, source);
  while (lines.Next(cells)) reader.Add(cells);
  return reader.Finish(project);
}

void WriteJointLog(const std::filesystem::path& file, const JointLog& log) {
  std::vector<Eigen::Index> sensors;
  std::string text = "t";
  for (const std::string& name : log.names) text += "," + MakeCell(name);
  for (Eigen::Index i = 0; i < log.torques.cols(); ++i) {
    if (log.torques.col(i).array().isNaN().all()) continue;
    sensors.push_back(i);
    text += "," + MakeCell(log.names[static_cast<std::size_t>(i)] + "_torque");
  }
  for (const ForceTorqueSensor& sensor : log.wrench_sensors) {
    for (const char* component : {"_fx", "_fy", "_fz", "_tx", "_ty", "_tz"}) {
      text += "," + MakeCell(sensor.name + component);
    }
  }
  text += '\n';
  for (Eigen::Index row = 0; row < log.time_s.size(); ++row) {
    text += FormatNumber(log.time_s[row]);
    for (double position : log.positions.row(row)) text += "," + FormatNumber(position);
    for (Eigen::Index i : sensors) text += "," + FormatNumber(log.torques(row, i));
    for (Eigen::Index i = 0; i < log.wrenches.cols(); ++i) {
      text += "," + FormatNumber(log.wrenches(row, i));
    }
    text += '\n';
  }
  WriteFile(file, text);
}

}  // namespace elastocal
