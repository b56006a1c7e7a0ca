#include "elastocal/io/posture_table.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/posture_columns.hpp"
#include "elastocal/io/table_lines.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// More are no static postures but a motion; and they bound the memory that a file can take.
constexpr std::size_t kMostRows = 100000;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The numbers of a table as they are read, row after row.
class RowReader {
 public:
  RowReader(const PostureColumns& columns, const TableLines& lines, const std::string& source,
            const Project& project)
      : columns_(columns), lines_(lines), source_(source) {
    const RobotTree& tree = project.tree;
    for (int joint : tree.coordinate_joint) {
      const auto given = project.recording.not_recorded.find(tree.joints[joint].name);
      fallback_.push_back(given == project.recording.not_recorded.end() ? 0.0 : given->second);
    }
  }

  void Add(const std::vector<std::string>& cells) {
    if (cells.size() != columns_.names.size()) {
      // A decimal comma splits a number in two.
      const bool commas =
          lines_.separator() == ',' && 2 * cells.size() >= 3 * columns_.names.size();
      Fail("found " + std::to_string(cells.size()) + " cells; the header has " +
           std::to_string(columns_.names.size()) + (commas ? "; decimal commas?" : ""));
    }
    if (line_.size() >= kMostRows) {
      Fail("more than " + std::to_string(kMostRows) +
           " rows; one for each static posture expected");
    }
    line_.push_back(lines_.line());
    if (columns_.time >= 0) time_.push_back(Number(cells, columns_.time));
    for (std::size_t c = 0; c < fallback_.size(); ++c) {
      const int column = columns_.coordinate_columns[c];
      q_.push_back(column < 0 ? fallback_[c] : Number(cells, column));
    }
    for (const std::array<int, 3>& xyz : columns_.marker_columns) AddMarker(cells, xyz);
  }

  void Finish(Recording& recording) {
    if (line_.empty()) throw InputError(source_ + ": no row below the header; postures expected");
    const auto rows = static_cast<Eigen::Index>(line_.size());
    const auto view = [rows](const std::vector<double>& values, std::size_t columns) {
      return Eigen::Map<const RowMajor>(values.data(), rows, static_cast<Eigen::Index>(columns));
    };
    recording.q = view(q_, fallback_.size());
    recording.markers = view(markers_, 3 * columns_.marker_columns.size());
    if (!time_.empty()) recording.time_s = view(time_, 1);
    recording.line = std::move(line_);
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(source_, lines_.line()) + message);
  }

  double Number(const std::vector<std::string>& cells, int column) const {
    return CellNumber(cells[column], columns_.names[column], source_, lines_.line());
  }

  void AddMarker(const std::vector<std::string>& cells, const std::array<int, 3>& xyz) {
    // All three cells empty: not seen. Only some: something went wrong, and Number() says where.
    const bool seen =
        std::any_of(xyz.begin(), xyz.end(), [&](int column) { return !cells[column].empty(); });
    for (int column : xyz) {
      markers_.push_back(seen ? Number(cells, column) : std::numeric_limits<double>::quiet_NaN());
    }
  }

  const PostureColumns& columns_;
  const TableLines& lines_;
  const std::string& source_;
  std::vector<double> fallback_;  ///< positions of joints without a column
  std::vector<double> q_, markers_, time_;
  std::vector<int> line_;
};

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

void NameJoints(const PostureColumns& columns, const RobotTree& tree, Recording& recording) {
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    if (columns.coordinate_columns[c] >= 0) continue;
    recording.joints_not_recorded.push_back(tree.joints[tree.coordinate_joint[c]].name);
  }
}

/// Coordinates of the tree that the recording holds.
std::vector<int> RecordedCoordinates(const Recording& recording, const RobotTree& tree) {
  const auto& absent = recording.joints_not_recorded;
  std::vector<int> coordinates;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const std::string& name = tree.joints[tree.coordinate_joint[c]].name;
    if (std::find(absent.begin(), absent.end(), name) == absent.end()) coordinates.push_back(c);
  }
  return coordinates;
}

std::string Header(const Recording& recording, const RobotTree& tree) {
  std::string header;
  if (recording.time_s.size() > 0) header += RecordingColumns().time + ",";
  for (const std::string& marker : recording.marker_names) {
    for (const std::string& column : DefaultMarkerColumns(marker)) header += MakeCell(column) + ",";
  }
  for (int c : RecordedCoordinates(recording, tree)) {
    header += MakeCell(tree.joints[tree.coordinate_joint[c]].name) + ",";
  }
  header.back() = '\n';
  return header;
}

}  // namespace

PostureTable ReadPostureTable(const std::filesystem::path& file, const Project& project) {
  std::ifstream stream = OpenTable(file);
  return ReadPostureTable(stream, file.string(), project);
}

PostureTable ReadPostureTable(std::istream& stream, const std::string& source,
                              const Project& project) {
  TableLines lines(stream, source);
  std::vector<std::string> cells;
  if (!lines.Next(cells)) throw InputError(source + ": is empty; a header row was expected");
  const PostureColumns columns = FindPostureColumns(cells, Place(source, lines.line()), project);

  RowReader rows(columns, lines, source, project);
  while (lines.Next(cells)) rows.Add(cells);
  PostureTable table;
  table.recording.source = source;
  rows.Finish(table.recording);
  NameMarkers(columns, project, table);
  NameJoints(columns, project.tree, table.recording);
  CheckPlausible(table.recording, project.tree);
  table.warnings = LimitWarnings(table.recording, project.tree);
  const std::string repetition = RepetitionWarning(table.recording);
  if (!repetition.empty()) table.warnings.push_back(repetition);
  return table;
}

void WritePostureTable(const std::filesystem::path& file, const Recording& recording,
                       const RobotTree& tree) {
  const std::vector<int> coordinates = RecordedCoordinates(recording, tree);
  std::string text = Header(recording, tree);
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.time_s.size() > 0) text += FormatNumber(recording.time_s[i]) + ",";
    for (double position : recording.markers.row(i)) {
      text += (std::isnan(position) ? "" : FormatNumber(position)) + ",";
    }
    for (int c : coordinates) text += FormatNumber(recording.q(i, c)) + ",";
    text.back() = '\n';
  }
  WriteFile(file, text);
}

}  // namespace elastocal
