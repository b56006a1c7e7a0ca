#include "elastocal/io/motion_file.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include "elastocal/io/motion_columns.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/table_lines.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// Half an hour at 100 Hz; this bounds the memory that a file can take.
constexpr std::size_t kMostRows = 200000;
constexpr double kSpeedMargin = 1.05;  // samples are rounded

class Reader {
 public:
  Reader(const MotionColumns& columns, const TableLines& lines, const std::string& source,
         const Project& project)
      : columns_(columns), lines_(lines), source_(source), tree_(project.tree), names_(project) {}

  void Add(const std::vector<std::string>& cells) {
    const std::string place = Place(source_, lines_.line());
    if (cells.size() != columns_.names.size()) {
      throw InputError(place + "found " + std::to_string(cells.size()) + " cells; the header has " +
                       std::to_string(columns_.names.size()));
    }
    if (line_.size() >= kMostRows) {
      throw InputError(place + "more than " + std::to_string(kMostRows) + " rows");
    }
    line_.push_back(lines_.line());
    if (columns_.time >= 0) AddTime(Number(cells, columns_.time), place);
    for (int column : columns_.coordinates) {
      q_.push_back(column < 0 ? std::numeric_limits<double>::quiet_NaN() : Number(cells, column));
    }
    if (columns_.support >= 0) support_.push_back(names_.Find(cells[columns_.support], place));
  }

  JointMotion Finish(std::size_t least_rows) {
    if (line_.size() < least_rows) {
      throw InputError(source_ + ": found " + std::to_string(line_.size()) +
                       " rows below the header; expected " + std::to_string(least_rows) +
                       " or more");
    }
    const auto rows = static_cast<Eigen::Index>(line_.size());
    JointMotion motion;
    motion.source = source_;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    motion.q = Eigen::Map<const RowMajor>(q_.data(), rows, tree_.coordinate_count());
    if (!time_.empty()) motion.time_s = Eigen::Map<const Eigen::VectorXd>(time_.data(), rows);
    motion.support = std::move(support_);
    motion.line = std::move(line_);
    for (int c = 0; c < tree_.coordinate_count(); ++c) {
      if (columns_.coordinates[c] >= 0) CheckJoint(motion, c);
    }
    return motion;
  }

 private:
  double Number(const std::vector<std::string>& cells, int column) const {
    return CellNumber(cells[column], columns_.names[column], source_, lines_.line());
  }

  void AddTime(double time, const std::string& place) {
    if (!time_.empty() && !(time > time_.back())) {
      throw InputError(place + "column " + Quote(columns_.names[columns_.time]) + ": found " +
                       FormatNumber(time) + " after " + FormatNumber(time_.back()) +
                       "; the time must increase from row to row");
    }
    time_.push_back(time);
  }

  /// A robot can be told only what it can do.
  void CheckJoint(const JointMotion& motion, int coordinate) const {
    const Joint& joint = tree_.joints[tree_.coordinate_joint[coordinate]];
    const auto place = [&](Eigen::Index row) { return Place(source_, motion.line[row]); };
    CheckRadians(joint, motion.q.col(coordinate), place);
    const auto fail = [&](Eigen::Index row, const std::string& what) {
      throw InputError(place(row) + "column " +
                       Quote(columns_.names[columns_.coordinates[coordinate]]) + ": " + what);
    };
    for (Eigen::Index row = 0; row < motion.q.rows(); ++row) {
      const double q = motion.q(row, coordinate);
      if (BeyondLimits(joint, q)) {
        fail(row, "found " + FormatNumber(q) + "; the joint's limits are " +
                      FormatNumber(joint.limits.lower) + " and " +
                      FormatNumber(joint.limits.upper));
      }
      if (motion.time_s.size() == 0 || row == 0) continue;
      const double speed = std::abs(q - motion.q(row - 1, coordinate)) /
                           (motion.time_s[row] - motion.time_s[row - 1]);
      if (speed > kSpeedMargin * joint.limits.velocity) {
        fail(row, "moves by " + FormatNumber(speed) +
                      (joint.type == JointType::kRevolute ? " rad/s" : " m/s") +
                      "; the joint's limit is " + FormatNumber(joint.limits.velocity));
      }
    }
  }

  const MotionColumns& columns_;
  const TableLines& lines_;
  const std::string& source_;
  const RobotTree& tree_;
  SupportNames names_;
  std::vector<double> time_, q_;
  std::vector<std::vector<int>> support_;
  std::vector<int> line_;
};

JointMotion Read(std::istream& stream, const std::string& source, const Project& project,
                 bool timed) {
  TableLines lines(stream, source);
  std::vector<std::string> cells;
  if (!lines.Next(cells)) throw InputError(source + ": is empty; a header row was expected");
  const MotionColumns columns =
      FindMotionColumns(cells, Place(source, lines.line()), project, timed);
  Reader reader(columns, lines, source, project);
  while (lines.Next(cells)) reader.Add(cells);
  return reader.Finish(timed ? 2 : 1);
}

}  // namespace

JointMotion ReadMotion(std::istream& stream, const std::string& source, const Project& project) {
  return Read(stream, source, project, true);
}

JointMotion ReadMotion(const std::filesystem::path& file, const Project& project) {
  std::ifstream stream = OpenTable(file);
  return ReadMotion(stream, file.string(), project);
}

JointMotion ReadPostureList(std::istream& stream, const std::string& source,
                            const Project& project) {
  return Read(stream, source, project, false);
}

JointMotion ReadPostureList(const std::filesystem::path& file, const Project& project) {
  std::ifstream stream = OpenTable(file);
  return ReadPostureList(stream, file.string(), project);
}

}  // namespace elastocal
