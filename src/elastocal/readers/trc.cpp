// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "elastocal/readers/csv_lines.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/marker_rows.hpp"

namespace elastocal {
namespace {

/// Reads track-row-column files of Motion Analysis and OpenSim: five lines of header, then frames.
class TrcReader {
 public:
  TrcReader(const ByteSource& source, const ReaderOptions& options)
      : source_(source), options_(options), lines_(source, '\t') {}

  RecordingFile Read() {
    ReadHeader();
    RecordingFile file;
    file.why_no_joints = "a TRC file has no joint positions";
    MarkerRows rows;
    Steps frames("Frame#", 1.0, 0.0), times("Time", 1.0 / rate_, 0.5 / rate_);
    std::size_t count = 0;
    while (lines_.Next()) {
      if (lines_.blank()) continue;  // one stands below the header
      frames.Check(lines_, lines_.Number(0));
      times.Check(lines_, lines_.Number(1));
      CheckEnd();
      for (std::size_t m = 0; m < names_.size(); ++m) {
        const auto [x, y, z] = lines_.Position(2 + 3 * m);
        rows.Add(unit_ * x, unit_ * y, unit_ * z);
      }
      ++count;
    }
    if (count == 0) throw InputError(source_.name() + ": no frame below the header");
    if (const auto stated = Header("NumFrames"); stated && *stated != static_cast<double>(count)) {
      throw InputError(source_.name() + ": found " + std::to_string(count) +
                       " frames; NumFrames is " + FormatNumber(*stated));
    }
    if (count > 1 && !lines_.blank() && EndsWithinALine(source_)) {
      rows.RemoveLast(names_.size());
      file.notes.emplace_back(kCutRow);
    }
    file.markers = rows.Take(source_.name(), DistinctNames(names_), rate_);
    return file;
  }

 private:
  void ReadHeader() {
    lines_.Expect("the first line of the header");
    lines_.Expect("the names of the header");
    for (std::size_t i = 0; i < lines_.count(); ++i) keys_.push_back(lines_.Name(i));
    lines_.Expect("the values of the header");
    for (std::size_t i = 0; i < keys_.size(); ++i) values_.emplace_back(lines_.Cell(i));
    rate_ = Header("DataRate").value_or(0.0);
    if (rate_ <= 0.0) lines_.Fail("DataRate: frames per second, above 0, were expected");
    std::string unit;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (keys_[i] == "Units") unit = values_[i];
    }
    unit_ = UnitOf(unit, options_.unit, source_.name());
    lines_.Expect("the names of the markers");
    ReadNames();
    lines_.Expect("the row X1, Y1, Z1, ...");
  }

  /// `Frame#  Time  NAME  -  -  NAME`.
  void ReadNames() {
    if (lines_.Cell(0) != "Frame#") lines_.FailCell(0, "'Frame#'");
    if (lines_.Cell(1) != "Time") lines_.FailCell(1, "'Time'");
    for (std::size_t i = 2; i < lines_.count(); ++i) {
      const bool first = (i - 2) % 3 == 0;
      if (!first && !lines_.Cell(i).empty()) lines_.FailCell(i, "an empty cell beside a name");
      if (!first || lines_.Cell(i).empty()) continue;
      if ((i - 2) / 3 != names_.size()) lines_.FailCell(i - 3, "the name of a marker");
      names_.push_back(lines_.Name(i));
    }
    if (names_.empty()) lines_.Fail("found no name of a marker");
    const auto stated = Header("NumMarkers");
    if (stated && *stated != static_cast<double>(names_.size())) {
      lines_.Fail("found " + std::to_string(names_.size()) + " names of markers; NumMarkers is " +
                  FormatNumber(*stated));
    }
  }

  void CheckEnd() const {
    for (std::size_t i = 2 + 3 * names_.size(); i < lines_.count(); ++i) {
      if (!lines_.Cell(i).empty()) lines_.FailCell(i, "the end of the line");
    }
  }

  std::optional<double> Header(std::string_view key) {
    for (std::size_t i = 0; i < keys_.size() && i < values_.size(); ++i) {
      if (keys_[i] == key) return lines_.Parse(values_[i]);
    }
    return std::nullopt;
  }

  const ByteSource& source_;
  const ReaderOptions& options_;
  CsvLines lines_;
  std::vector<std::string> keys_, values_, names_;
  double rate_ = 0.0, unit_ = 0.0;
};

}  // namespace

bool IsTrc(std::string_view head) { return head.starts_with("PathFileType"); }

RecordingFile ReadTrc(const ByteSource& source, const ReaderOptions& options) {
  return TrcReader(source, options).Read();
}

}  // namespace elastocal
