// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/qtm_tsv.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "elastocal/files/bounds.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/decimal_numbers.hpp"
#include "elastocal/readers/marker_rows.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// Largest number of lines above the frames: more are no header, and would only take long to read.
constexpr int kMostHeaderLines = 10000;

/// The header above the frames: lines `KEY<tab>value` and a row of column names `[Frame] [Time]
/// NAME X ...`. Either may be absent, but one of them has to name the markers.
struct QtmHeader {
  std::vector<std::string> names;     ///< of the markers, one or more
  double rate_hz = 0.0;               ///< 0 where the file does not say
  std::optional<std::size_t> frames;  ///< how many there should be, where the file says so
  /// The columns before those of the markers, "Frame" and "Time", where a row names the columns.
  std::optional<std::vector<std::string>> leading_columns;
};

/// The numbers of the frames.
struct QtmFrames {
  Eigen::MatrixXd positions;                 ///< frames x 3 N_M, m; NaN where not seen
  std::vector<std::vector<double>> leading;  ///< columns before those of the markers, at most two
  /// "Frame" or "Time" for each of `leading`; empty if there is one and no row names it.
  std::vector<std::string> leading_names;
  int first_line = 1;
};

/// A QTM file line by line: lines and their cells. Programs like to end their lines with a tab.
struct QtmLines {
  LineReader reader;
  std::vector<std::string_view> cells = {};  ///< of the line read last
  DecimalNumbers numbers = {};

  bool Next() {
    std::span<char> line;
    if (!reader.Next(line)) return false;
    SplitCells(line, '\t', Quotes::kOrdinary, cells);
    return true;
  }
  bool blank() const { return cells.size() == 1 && cells[0].empty(); }
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(reader.source(), std::max(reader.line(), 1)) + message);
  }
  [[noreturn]] void FailCell(std::size_t i, const std::string& name,
                             const std::string& expected) const {
    Fail("column " + std::to_string(i + 1) + name + ": found " + Quote(cells[i]) + "; expected " +
         expected);
  }
};

bool IsKey(std::string_view cell) {
  constexpr std::string_view kCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
  return !cell.empty() && cell.find_first_not_of(kCharacters) == std::string_view::npos &&
         cell.find_first_of("0123456789") != 0;
}

class HeaderReader {
 public:
  explicit HeaderReader(QtmLines& lines) : lines_(lines) {}

  /// Reads up to the first frame, whose cells are then in the lines; there may be none.
  QtmHeader Read() {
    bool header = true;
    while (header && lines_.Next()) header = ReadLine();
    if (header) lines_.cells.clear();
    if (header_.names.empty()) {
      lines_.Fail(
          "nothing above names the markers; expected a line MARKER_NAMES and the names, or a row "
          "of column names NAME X, NAME Y, NAME Z, ..., separated by tabs");
    }
    if (marker_count_ && *marker_count_ != header_.names.size()) {
      lines_.Fail("above this line " + std::to_string(header_.names.size()) +
                  " markers are named; NO_OF_MARKERS is " + std::to_string(*marker_count_));
    }
    return std::move(header_);
  }

 private:
  /// False for the first frame.
  bool ReadLine() {
    if (lines_.reader.line() > kMostHeaderLines) {
      lines_.Fail("more than 10000 lines above the first frame");
    }
    if (lines_.blank()) return true;
    const std::string_view first = lines_.cells[0];
    if (header_.leading_columns || IsGap(first) || lines_.numbers.Parse(first)) return false;
    std::vector<std::string> cells(lines_.cells.begin(), lines_.cells.end());
    while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    if (first == "Frame" || first == "Time" || first.ends_with(" X")) {
      ReadColumnNames(cells);
    } else if (IsKey(first)) {
      ReadKey(cells);
    } else {
      lines_.FailCell(0, "",
                      "a header line (KEY and value), column names (Frame, Time, NAME X, ...) or "
                      "numbers, separated by tabs");
    }
    return true;
  }

  void ReadKey(const std::vector<std::string>& cells) {
    const std::set<std::string> known = {"NO_OF_FRAMES", "NO_OF_MARKERS", "FREQUENCY",
                                         "DATA_INCLUDED", "MARKER_NAMES"};
    const std::string& key = cells[0];
    if (!known.contains(key)) return;
    if (!keys_.insert(key).second) lines_.Fail("a second line " + key);
    const std::string value = cells.size() > 1 ? cells[1] : "";
    if (key == "NO_OF_FRAMES") header_.frames = Count(key, value);
    if (key == "NO_OF_MARKERS") marker_count_ = Count(key, value);
    if (key == "MARKER_NAMES") SetNames({cells.begin() + 1, cells.end()});
    if (key == "DATA_INCLUDED" && value != "3D") {
      lines_.Fail("DATA_INCLUDED: found " + Quote(value) +
                  "; 3D, positions of markers, was expected");
    }
    if (key != "FREQUENCY") return;
    header_.rate_hz = lines_.numbers.Parse(value).value_or(0.0);
    if (header_.rate_hz <= 0.0) {
      lines_.Fail("FREQUENCY: found " + Quote(value) +
                  "; frames per second, above 0, were expected");
    }
  }

  std::size_t Count(const std::string& key, const std::string& value) const {
    constexpr double kMost = 1e9;
    const double number = ParseNumber(value).value_or(-1.0);
    if (number < 0.0 || number > kMost || number != std::floor(number)) {
      lines_.Fail(key + ": found " + Quote(value) + "; a whole number was expected");
    }
    return static_cast<std::size_t>(number);
  }

  void ReadColumnNames(const std::vector<std::string>& cells) {
    std::vector<std::string> leading;
    std::size_t i = 0;
    for (; i < cells.size() && (cells[i] == "Frame" || cells[i] == "Time"); ++i) {
      if (i > 0 && cells[i] == leading[0]) lines_.Fail("column 2: a second column " + cells[i]);
      leading.push_back(cells[i]);
    }
    std::vector<std::string> names;
    for (; i < cells.size(); ++i) {
      const std::size_t axis = (i - leading.size()) % 3;
      if (axis == 0) names.push_back(cells[i].substr(0, cells[i].rfind(' ')));
      const std::string expected = names.back() + ' ' + "XYZ"[axis];
      if (cells[i] != expected) lines_.FailCell(i, "", Quote(expected));
    }
    if ((cells.size() - leading.size()) % 3 != 0) {
      lines_.Fail("the columns X, Y and Z of marker " + Quote(names.back()) + " are not complete");
    }
    if (keys_.contains("MARKER_NAMES") && names != header_.names) {
      lines_.Fail("the columns are of other markers than MARKER_NAMES says");
    }
    SetNames(std::move(names));
    header_.leading_columns = std::move(leading);
  }

  void SetNames(std::vector<std::string> names) {
    std::set<std::string> seen;
    for (const std::string& name : names) {
      if (name.empty()) lines_.Fail("a marker without a name");
      RequireUtf8(name, lines_.reader.source(), lines_.reader.line());
      if (!seen.insert(name).second) lines_.Fail("two markers of the name " + Quote(name));
    }
    header_.names = std::move(names);
  }

  QtmLines& lines_;
  QtmHeader header_;
  std::set<std::string> keys_;
  std::optional<std::size_t> marker_count_;
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

MarkerTrajectories ParseQtmStream(std::istream& stream, const std::string& source) {
  QtmLines lines{LineReader(stream, source)};
  const QtmHeader header = HeaderReader(lines).Read();
  QtmFrames frames = FrameReader(lines, header).Read();
  MarkerTrajectories result;
  result.source = source;
  result.names = header.names;
  result.rate_hz = Timing(header.rate_hz, frames, source).Rate();
  result.positions = std::move(frames.positions);
  return result;
}

}  // namespace

MarkerTrajectories ReadQtmTsv(const std::filesystem::path& file) {
  const ByteSource source = ByteSource::Open(file);
  SourceStream stream(source);
  return ParseQtmStream(stream, source.name());
}

MarkerTrajectories ParseQtmTsv(std::string_view text, const std::string& source) {
  TextStream stream(text);
  return ParseQtmStream(stream, source);
}

}  // namespace elastocal
