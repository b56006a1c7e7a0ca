// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "elastocal/readers/csv_lines.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/marker_rows.hpp"

namespace elastocal {
namespace {

constexpr std::array<std::string_view, 6> kSections = {"Trajectories", "Devices",       "Segments",
                                                       "Joints",       "Model Outputs", "Events"};

bool IsSection(std::string_view cell) {
  return std::find(kSections.begin(), kSections.end(), cell) != kSections.end();
}

/// The section "Trajectories" of an export by Vicon Nexus. The others, of force plates and models,
/// are passed over.
class ViconReader {
 public:
  ViconReader(const ByteSource& source, const ReaderOptions& options)
      : source_(source), options_(options), lines_(source, FindFirstSeparator(source)) {}

  RecordingFile Read() {
    RecordingFile file;
    file.why_no_joints = "a Vicon CSV has no joint positions";
    file.why_no_markers = "it has no section Trajectories";
    while (lines_.Next()) {
      const std::string_view first = lines_.Cell(0);
      if (!IsSection(first)) continue;
      if (first != "Trajectories") {
        file.notes.push_back("the section " + std::string(first) + " is passed over");
      } else if (file.markers) {
        lines_.Fail("a second section Trajectories");
      } else {
        file.markers = ReadTrajectories(file.notes);
      }
    }
    return file;
  }

 private:
  MarkerTrajectories ReadTrajectories(std::vector<std::string>& notes) {
    lines_.Expect("the rate of the trajectories");
    const double rate = lines_.Number(0);
    if (rate <= 0.0) lines_.FailCell(0, "frames per second, above 0,");
    lines_.Expect("the names of the trajectories");
    ReadNames();
    lines_.Expect("the row Frame, Sub Frame, X, Y, Z");
    CheckColumns();
    lines_.Expect("the row of units");
    const double unit = Unit();
    MarkerRows rows;
    Steps steps("Frame", 1.0, 0.0);
    std::size_t frames = 0;
    bool more = false;
    while ((more = lines_.Next()) && !lines_.blank()) {
      if (lines_.count() > width_ &&
          std::any_of(lines_.cells().begin() + static_cast<std::ptrdiff_t>(width_),
                      lines_.cells().end(), [](auto cell) { return !cell.empty(); })) {
        lines_.Fail("found more than the " + std::to_string(width_) + " cells of the header");
      }
      steps.Check(lines_, lines_.Number(0));
      for (const std::size_t column : columns_) {
        const auto [x, y, z] = lines_.Position(column);
        rows.Add(unit * x, unit * y, unit * z);
      }
      ++frames;
    }
    if (!more && frames > 0 && EndsWithinALine(source_)) {
      rows.RemoveLast(columns_.size());
      --frames;
      notes.emplace_back(kCutRow);
    }
    if (frames == 0) lines_.Fail("the section Trajectories has no frame");
    return rows.Take(source_.name(), DistinctNames(names_), rate);
  }

  /// `,,subject:marker,,,subject:marker`: a name stands above the first column of its marker.
  void ReadNames() {
    for (std::size_t i = 2; i < lines_.count(); ++i) {
      if (lines_.Cell(i).empty()) continue;
      if (!columns_.empty() && i < columns_.back() + 3) {
        lines_.FailCell(i, "an empty cell beside the name " + Quote(names_.back()));
      }
      columns_.push_back(i);
      names_.push_back(lines_.Name(i));
    }
    if (columns_.empty()) lines_.Fail("found no name of a marker");
  }

  void CheckColumns() {
    width_ = lines_.count();
    constexpr std::array<std::string_view, 3> kAxes = {"X", "Y", "Z"};
    if (lines_.Cell(0) != "Frame") lines_.FailCell(0, "'Frame'");
    for (const std::size_t column : columns_) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (lines_.Cell(column + k) != kAxes[k]) {
          lines_.FailCell(column + k, Quote(kAxes[k]));
        }
      }
    }
    width_ = std::max(width_, columns_.back() + 3);
  }

  double Unit() const {
    const std::string_view first = lines_.Cell(columns_[0]);
    for (const std::size_t column : columns_) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (lines_.Cell(column + k) != first) lines_.FailCell(column + k, Quote(first));
      }
    }
    return UnitOf(first, options_.unit, source_.name());
  }

  const ByteSource& source_;
  const ReaderOptions& options_;
  CsvLines lines_;
  std::vector<std::string> names_;
  std::vector<std::size_t> columns_;  ///< of the X of each
  std::size_t width_ = 0;
};

}  // namespace

bool IsViconCsv(std::string_view head) {
  // The first lines may be empty; then comes the name of a section, by itself.
  constexpr std::string_view kEnds = ",;\t ";
  while (!head.empty()) {
    const std::size_t end = std::min(head.find_first_of("\r\n"), head.size());
    std::string_view line = head.substr(0, end);
    while (!line.empty() && kEnds.find(line.back()) != std::string_view::npos) {
      line.remove_suffix(1);
    }
    if (!line.empty()) {
      if (!IsSection(line)) return false;
      // A line with the rate follows.
      std::string_view next = head.substr(std::min(head.size(), end));
      next.remove_prefix(std::min(next.find_first_not_of("\r\n"), next.size()));
      next = next.substr(0, next.find_first_of(",;\t\r\n"));
      return line == "Events" || next.empty() || ParseNumber(next).has_value();
    }
    head.remove_prefix(std::min(head.size(), end + 1));
  }
  return false;
}

RecordingFile ReadViconCsv(const ByteSource& source, const ReaderOptions& options) {
  return ViconReader(source, options).Read();
}

}  // namespace elastocal
