// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/qtm_tsv.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/files/bounds.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/csv_lines.hpp"
#include "elastocal/readers/marker_rows.hpp"
#include "elastocal/readers/qtm_header.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The numbers of the frames.
struct QtmFrames {
  Eigen::MatrixXd positions;                 ///< frames x 3 N_M, m; NaN where not seen
  std::vector<std::vector<double>> leading;  ///< columns before those of the markers
  /// "Frame", "Time" or "SMPTE" (not read) for each of `leading`; empty if there is one and no row
  /// names it.
  std::vector<std::string> leading_names;
  int first_line = 1;
};

/// Number of columns before those of the markers, if no row names them. They are never empty,
/// whereas the cells of a marker are all empty or all full.
std::size_t InferLeadingColumns(const std::vector<std::string_view>& cells, std::size_t markers) {
  const auto full = static_cast<std::size_t>(std::count_if(
      cells.begin(), cells.end(), [](std::string_view cell) { return !cell.empty(); }));
  const std::size_t leading = full % 3;
  const std::size_t known = leading + 3 * markers;
  if (cells.size() == known || cells.size() == known + 1) return leading;
  // Something is wrong in this row; what, is said when it is read.
  return cells.size() > 3 * markers ? std::min<std::size_t>(cells.size() - 3 * markers, 2) : 0;
}

/// Reads the frames, of which the first is in the lines already.
class FrameReader {
 public:
  FrameReader(QtmLines& lines, const QtmHeader& header) : lines_(lines), header_(header) {}

  QtmFrames Read() {
    const std::string& source = lines_.reader.source();
    if (lines_.cells.empty()) throw InputError(source + ": no frame below the header");
    frames_.first_line = lines_.reader.line();
    FindLayout();
    std::size_t count = 0;
    do {
      if (lines_.blank()) break;
      ReadRow();
      ++count;
    } while (lines_.Next());
    while (lines_.Next()) {
      if (!lines_.blank()) lines_.Fail("a frame below an empty line");
    }
    if (header_.frames && *header_.frames != count) {
      throw InputError(source + ": found " + std::to_string(count) + " frames; NO_OF_FRAMES is " +
                       std::to_string(*header_.frames) +
                       " (correct it if frames were left out on purpose)");
    }
    frames_.positions = rows_.Take(source, header_.names, header_.rate_hz).positions;
    return std::move(frames_);
  }

 private:
  void FindLayout() {
    const std::size_t markers = header_.names.size();
    if (header_.leading_columns) {
      frames_.leading_names = *header_.leading_columns;
      frames_.leading.resize(frames_.leading_names.size());
    } else {
      frames_.leading.resize(InferLeadingColumns(lines_.cells, markers));
      if (frames_.leading.size() == 2) frames_.leading_names = {"Frame", "Time"};
    }
    const std::size_t expected = frames_.leading.size() + 3 * markers;
    width_ = lines_.cells.size();
    if (width_ == expected || (width_ == expected + 1 && lines_.cells.back().empty())) return;
    lines_.Fail("found " + std::to_string(width_) + " cells; " + std::to_string(expected) +
                " were expected: " + std::to_string(frames_.leading.size()) +
                " (Frame, Time) and 3 for each of " + std::to_string(markers) + " markers");
  }

  void ReadRow() {
    if (lines_.cells.size() != width_) {
      lines_.Fail("found " + std::to_string(lines_.cells.size()) + " cells; the rows above have " +
                  std::to_string(width_));
    }
    std::size_t i = 0;
    for (std::vector<double>& column : frames_.leading) {
      if (frames_.leading.size() == frames_.leading_names.size() &&
          frames_.leading_names[i] == "SMPTE") {
        ++i;
        continue;
      }
      column.push_back(Number(i));
      if (std::isnan(column.back())) Fail(i, "a number");
      ++i;
    }
    for (std::size_t m = 0; m < header_.names.size(); ++m, i += 3) {
      const double x = Number(i), y = Number(i + 1), z = Number(i + 2);
      const int missing = std::isnan(x) + std::isnan(y) + std::isnan(z);
      if (missing == 1 || missing == 2) {
        Fail(i, "X, Y and Z, or none of them for a marker that was not seen");
      }
      static const NumberRange range = BoundsOf("Qualisys TSV X, Y, Z");
      for (std::size_t axis = 0; axis < 3 && missing == 0; ++axis) {
        const double position = axis == 0 ? x : axis == 1 ? y : z;
        if (!range.Contains(position)) Fail(i + axis, range.InWords() + " (mm)");
      }
      rows_.Add(kMetresPerMm * x, kMetresPerMm * y, kMetresPerMm * z);  // 0 0 0 is a gap
    }
    if (i < width_ && !lines_.cells[i].empty()) Fail(i, "the end of the line");
  }

  /// NaN for a gap.
  double Number(std::size_t i) const {
    if (const std::optional<double> number = lines_.numbers.Parse(lines_.cells[i])) return *number;
    if (IsGap(lines_.cells[i])) return kNaN;
    Fail(i, lines_.numbers.expected());
  }

  /// Throws about a cell; its column may have a name.
  [[noreturn]] void Fail(std::size_t i, const std::string& expected) const {
    const std::size_t leading = frames_.leading.size();
    const std::size_t marker = i < leading ? 0 : (i - leading) / 3;
    std::string name;
    if (i < leading) {
      name = frames_.leading_names.empty() ? "" : " (" + frames_.leading_names[i] + ")";
    } else if (marker < header_.names.size()) {
      name = " (" + header_.names[marker] + " " + "XYZ"[(i - leading) % 3] + ")";
    }
    lines_.FailCell(i, name, expected);
  }

  QtmLines& lines_;
  const QtmHeader& header_;
  QtmFrames frames_;
  std::size_t width_ = 0;  ///< cells of each row
  MarkerRows rows_;
};

/// Judges the columns Frame and Time, and finds the rate.
class Timing {
 public:
  Timing(double rate_hz, const QtmFrames& frames, const std::string& source)
      : rate_hz_(rate_hz), frames_(frames), source_(source) {}

  double Rate() const {
    double rate = rate_hz_;
    for (std::size_t i = 0; i < frames_.leading.size(); ++i) {
      const std::vector<double>& column = frames_.leading[i];
      if (IsFrameColumn(i)) {
        CheckSteps("Frame", column, 1.0, 0.0);
      } else if (column.size() > 1) {
        rate = RateFromTime(column);
      }
    }
    if (rate > 0.0 && std::isfinite(rate)) return rate;
    throw InputError(source_ +
                     ": the frame rate is not known; give it in Hz in a line of its own above the "
                     "frames, FREQUENCY<tab>100, or export the file with the column Time");
  }

 private:
  [[noreturn]] void Fail(std::size_t frame, const std::string& message) const {
    throw InputError(Place(source_, frames_.first_line + static_cast<int>(frame)) + message);
  }

  /// One column that no row names holds frame numbers if it counts by one.
  bool IsFrameColumn(std::size_t i) const {
    if (!frames_.leading_names.empty()) return frames_.leading_names[i] == "Frame";
    return WrongStep(frames_.leading[i], 1.0, 0.0) == 0;
  }

  double RateFromTime(const std::vector<double>& time) const {
    const std::size_t last = time.size() - 1;
    const double elapsed = time[last] - time[0];
    if (!(elapsed > 0.0)) Fail(last, "column Time: not later than in the first frame");
    const double rate = rate_hz_ > 0.0 ? rate_hz_ : static_cast<double>(last) / elapsed;
    // Times are rounded; half a frame tells a frame left out from rounding.
    CheckSteps("Time", time, 1.0 / rate, 0.5 / rate);
    if (std::abs(elapsed * rate - static_cast<double>(last)) >= 0.5) {
      Fail(last, "column Time: from the first frame to this one " + FormatNumber(elapsed) +
                     " s pass; by FREQUENCY, " + FormatNumber(rate) + ", it is " +
                     FormatNumber(static_cast<double>(last) / rate) + " s");
    }
    return rate;
  }

  /// The first entry that does not follow the one before by `step`; 0 where all do.
  static std::size_t WrongStep(const std::vector<double>& values, double step, double tolerance) {
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (!(std::abs(values[i] - values[i - 1] - step) <= tolerance)) return i;
    }
    return 0;
  }

  void CheckSteps(const std::string& name, const std::vector<double>& values, double step,
                  double tolerance) const {
    const std::size_t i = WrongStep(values, step, tolerance);
    if (i == 0) return;
    Fail(i, "column " + name + ": found " + FormatNumber(values[i]) + " after " +
                FormatNumber(values[i - 1]) + "; steps of " + FormatNumber(step) +
                " were expected, with no frame left out");
  }

  double rate_hz_;  ///< by the header; 0 where it does not say
  const QtmFrames& frames_;
  const std::string& source_;
};

/// Removes the trajectories without a name.
void DropUnnamed(MarkerTrajectories& trajectories, std::vector<std::string>* notes) {
  std::vector<Eigen::Index> columns;
  for (std::size_t m = 0; m < trajectories.names.size(); ++m) {
    if (trajectories.names[m].empty()) continue;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      columns.push_back(3 * static_cast<Eigen::Index>(m) + axis);
    }
  }
  const std::size_t unnamed = std::erase(trajectories.names, "");
  if (unnamed == 0) return;
  trajectories.positions = trajectories.positions(Eigen::all, columns).eval();
  if (notes == nullptr) return;
  notes->push_back(std::to_string(unnamed) + " trajectories without a name are passed over");
}

MarkerTrajectories ParseQtmStream(std::istream& stream, const std::string& source,
                                  std::vector<std::string>* notes) {
  QtmLines lines{LineReader(stream, source)};
  const QtmHeader header = ReadQtmHeader(lines);
  QtmFrames frames = FrameReader(lines, header).Read();
  MarkerTrajectories result;
  result.source = source;
  result.names = header.names;
  result.rate_hz = Timing(header.rate_hz, frames, source).Rate();
  result.positions = std::move(frames.positions);
  DropUnnamed(result, notes);
  return result;
}

}  // namespace

MarkerTrajectories ReadQtmTsv(const std::filesystem::path& file, std::vector<std::string>* notes) {
  const ByteSource source = ByteSource::Open(file);
  SourceStream stream(source);
  MarkerTrajectories trajectories = ParseQtmStream(stream, source.name(), notes);
  if (trajectories.positions.rows() > 1 && EndsWithinALine(source)) {
    trajectories.positions.conservativeResize(trajectories.positions.rows() - 1, Eigen::NoChange);
    if (notes != nullptr) notes->emplace_back(kCutRow);
  }
  return trajectories;
}

MarkerTrajectories ParseQtmTsv(std::string_view text, const std::string& source) {
  TextStream stream(text);
  return ParseQtmStream(stream, source, nullptr);
}

}  // namespace elastocal
