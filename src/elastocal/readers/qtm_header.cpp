// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/qtm_header.hpp"

#include <array>
#include <cmath>
#include <set>

#include "elastocal/math/utf8.hpp"

namespace elastocal {
namespace {

/// Largest number of lines above the frames: more are no header, and would only take long to read.
constexpr int kMostHeaderLines = 10000;

bool IsQtmKey(std::string_view cell) {
  constexpr std::string_view kCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
  return !cell.empty() && cell.find_first_not_of(kCharacters) == std::string_view::npos &&
         cell.find_first_of("0123456789") != 0;
}

/// Whether the name is of a column before those of the markers.
bool IsLeadingColumn(std::string_view name) {
  return name == "Frame" || name == "Time" || name == "SMPTE";
}

class QtmHeaderReader {
 public:
  explicit QtmHeaderReader(QtmLines& lines) : lines_(lines) {}

  /// Reads up to the first frame, whose cells are then in the lines; there may be none.
  QtmHeader Read() {
    bool header = true;
    while (header && lines_.Next()) header = ReadLine();
    if (header) lines_.cells.clear();
    // A line may end with the names of markers that have none.
    if (marker_count_ && header_.names.size() < std::min(*marker_count_, name_cells_)) {
      header_.names.resize(std::min(*marker_count_, name_cells_));
    }
    if (std::ranges::all_of(header_.names, &std::string::empty)) {
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
    if (IsLeadingColumn(first) || first.ends_with(" X")) {
      ReadColumnNames(cells);
    } else if (IsQtmKey(first)) {
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
    if (key == "MARKER_NAMES") {
      name_cells_ = lines_.cells.size() - 1;
      SetNames({cells.begin() + 1, cells.end()});
    }
    if (key == "DATA_INCLUDED" && value != "3D") {
      lines_.Fail("DATA_INCLUDED: found " + Quote(value) +
                  "; 3D, positions of markers, was expected");
    }
    // With a clock of another device, the column Time tells the rate.
    if (key != "FREQUENCY" || value == "EXT") return;
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
    for (; i < cells.size() && IsLeadingColumn(cells[i]); ++i) {
      if (std::ranges::find(leading, cells[i]) != leading.end()) {
        lines_.Fail("column " + std::to_string(i + 1) + ": a second column " + cells[i]);
      }
      leading.push_back(cells[i]);
    }
    std::vector<std::string> names;
    for (; i < cells.size(); ++i) {
      const std::size_t axis = (i - leading.size()) % 3;
      const bool unnamed = cells[i] == "X";
      if (axis == 0) names.push_back(unnamed ? "" : cells[i].substr(0, cells[i].rfind(' ')));
      const std::string expected = (names.back().empty() ? "" : names.back() + ' ') + "XYZ"[axis];
      if (cells[i] != expected) lines_.FailCell(i, "", Quote(expected));
    }
    if ((cells.size() - leading.size()) % 3 != 0) {
      lines_.Fail("the columns X, Y and Z of marker " + Quote(names.back()) + " are not complete");
    }
    if (header_.names.size() < names.size()) header_.names.resize(names.size());  // unnamed ones
    if (keys_.contains("MARKER_NAMES") && names != header_.names) {
      lines_.Fail("the columns are of other markers than MARKER_NAMES says");
    }
    SetNames(std::move(names));
    header_.leading_columns = std::move(leading);
  }

  void SetNames(std::vector<std::string> names) {
    std::set<std::string> seen;
    for (const std::string& name : names) {
      if (name.empty()) continue;
      RequireUtf8(name, lines_.reader.source(), lines_.reader.line());
      if (!seen.insert(name).second) lines_.Fail("two markers of the name " + Quote(name));
    }
    header_.names = std::move(names);
  }

  QtmLines& lines_;
  QtmHeader header_;
  std::set<std::string> keys_;
  std::optional<std::size_t> marker_count_;
  std::size_t name_cells_ = 0;  ///< behind MARKER_NAMES, also empty ones
};

/// The first line of a text, without a byte order mark.
std::string_view FirstLine(std::string_view head) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (head.starts_with(kByteOrderMark)) head.remove_prefix(kByteOrderMark.size());
  return head.substr(0, head.find_first_of("\r\n"));
}

/// Takes the first cell off the line, which is then empty where it was the last.
std::string_view TakeCell(std::string_view& line) {
  const std::string_view cell = line.substr(0, line.find('\t'));
  line.remove_prefix(std::min(line.size(), cell.size() + 1));
  return Trim(cell);
}

}  // namespace

QtmHeader ReadQtmHeader(QtmLines& lines) { return QtmHeaderReader(lines).Read(); }

bool BeginsLikeQtmTsv(std::string_view head) {
  std::string_view line = FirstLine(head);
  if (line.find('\t') == std::string_view::npos) return false;
  std::string_view cell = TakeCell(line);
  if (cell == "TIME" || cell == "T") return false;  // no keys of such files, but names of a time
  if (!IsLeadingColumn(cell)) return cell.ends_with(" X") || IsQtmKey(cell);
  while (IsLeadingColumn(cell) && !line.empty()) cell = TakeCell(line);
  return IsLeadingColumn(cell) || cell == "X" || cell.ends_with(" X");
}

bool IsSurelyQtmTsv(std::string_view head) {
  std::string_view line = FirstLine(head);
  if (line.find('\t') == std::string_view::npos) return false;
  constexpr std::array<std::string_view, 8> kKeys = {
      "NO_OF_FRAMES",  "NO_OF_CAMERAS", "NO_OF_MARKERS", "FREQUENCY",
      "DATA_INCLUDED", "MARKER_NAMES",  "TIME_STAMP",    "Frame"};
  return std::ranges::find(kKeys, TakeCell(line)) != kKeys.end();
}

}  // namespace elastocal
