#include "elastocal/io/qtm_header.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"

namespace elastocal {
namespace {

/// The cells of a line, without spaces around them and without empty ones at the end: programs
/// like to end their lines with a tab.
std::vector<std::string> Cells(std::string_view line) {
  std::vector<std::string> cells;
  for (;;) {
    const std::size_t tab = std::min(line.find('\t'), line.size());
    cells.emplace_back(Trim(line.substr(0, tab)));
    if (tab == line.size()) break;
    line.remove_prefix(tab + 1);
  }
  while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

/// More are no header, and would only take long to read.
constexpr int kMostLines = 10000;
constexpr std::size_t kLongestLine = 1u << 20;

bool IsKey(const std::string& cell) {
  constexpr std::string_view kCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
  return !cell.empty() && cell.find_first_not_of(kCharacters) == std::string::npos &&
         cell.find_first_of("0123456789") != 0;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& source) : text_(text), source_(source) {}

  QtmHeader Read() {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) header_.data_begin = kByteOrderMark.size();
    for (; header_.data_begin < text_.size(); NextLine()) {
      if (!ReadLine()) break;
    }
    Finish();
    return std::move(header_);
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(source_, header_.data_line) + message);
  }

  std::string_view Line() const {
    const std::string_view rest = text_.substr(header_.data_begin);
    return rest.substr(0, rest.find('\n'));
  }

  void NextLine() {
    header_.data_begin = std::min(header_.data_begin + Line().size() + 1, text_.size());
    ++header_.data_line;
  }

  /// False for the first frame.
  bool ReadLine() {
    const std::string_view line = Line();
    if (line.size() > kLongestLine) Fail("a line of more than 1 MiB");
    if (header_.data_line > kMostLines) Fail("more than 10000 lines above the first frame");
    if (line.find_first_not_of(" \r") == std::string_view::npos) return true;
    const std::string first(Trim(line.substr(0, line.find('\t'))));
    if (header_.leading_columns || IsQtmGap(first) || ParseNumber(first)) return false;
    if (first == "Frame" || first == "Time" || first.ends_with(" X")) {
      RequireUtf8(line, source_, header_.data_line);
      ReadColumnNames(Cells(line));
    } else if (IsKey(first)) {
      ReadKey(first, Cells(line));
    } else {
      Fail("column 1: found " + Quote(first) +
           "; a header line (KEY and value), column names (Frame, Time, NAME X, ...) or numbers, "
           "separated by tabs, were expected");
    }
    return true;
  }

  void ReadKey(const std::string& key, const std::vector<std::string>& cells) {
    const std::set<std::string> known = {"NO_OF_FRAMES", "NO_OF_MARKERS", "FREQUENCY",
                                         "DATA_INCLUDED", "MARKER_NAMES"};
    if (!known.contains(key)) return;
    if (!keys_.insert(key).second) Fail("a second line " + key);
    const std::string value = cells.size() > 1 ? cells[1] : "";
    if (key == "NO_OF_FRAMES") header_.frames = Count(key, value);
    if (key == "NO_OF_MARKERS") marker_count_ = Count(key, value);
    if (key == "MARKER_NAMES") {
      RequireUtf8(Line(), source_, header_.data_line);
      SetNames({cells.begin() + 1, cells.end()});
    }
    if (key == "DATA_INCLUDED" && value != "3D") {
      Fail("DATA_INCLUDED: found " + Quote(value) + "; 3D, positions of markers, was expected");
    }
    if (key != "FREQUENCY") return;
    header_.rate_hz = ParseNumber(value).value_or(0.0);
    if (header_.rate_hz <= 0.0) {
      Fail("FREQUENCY: found " + Quote(value) + "; frames per second, above 0, were expected");
    }
  }

  std::size_t Count(const std::string& key, const std::string& value) const {
    constexpr double kMost = 1e9;
    const double number = ParseNumber(value).value_or(-1.0);
    if (number < 0.0 || number > kMost || number != std::floor(number)) {
      Fail(key + ": found " + Quote(value) + "; a whole number was expected");
    }
    return static_cast<std::size_t>(number);
  }

  void ReadColumnNames(const std::vector<std::string>& cells) {
    std::vector<std::string> leading;
    std::size_t i = 0;
    for (; i < cells.size() && (cells[i] == "Frame" || cells[i] == "Time"); ++i) {
      if (i > 0 && cells[i] == leading[0]) Fail("column 2: a second column " + cells[i]);
      leading.push_back(cells[i]);
    }
    std::vector<std::string> names;
    for (; i < cells.size(); ++i) {
      const std::size_t axis = (i - leading.size()) % 3;
      if (axis == 0) names.push_back(cells[i].substr(0, cells[i].rfind(' ')));
      const std::string expected = names.back() + ' ' + "XYZ"[axis];
      if (cells[i] != expected) {
        Fail("column " + std::to_string(i + 1) + ": found " + Quote(cells[i]) + "; " +
             Quote(expected) + " was expected");
      }
    }
    if ((cells.size() - leading.size()) % 3 != 0) {
      Fail("the columns X, Y and Z of marker " + Quote(names.back()) + " are not complete");
    }
    if (keys_.contains("MARKER_NAMES") && names != header_.names) {
      Fail("the columns are of other markers than MARKER_NAMES says");
    }
    SetNames(std::move(names));
    header_.leading_columns = std::move(leading);
  }

  void SetNames(std::vector<std::string> names) {
    std::set<std::string> seen;
    for (const std::string& name : names) {
      if (name.empty()) Fail("a marker without a name");
      if (!seen.insert(name).second) Fail("two markers of the name " + Quote(name));
    }
    header_.names = std::move(names);
  }

  void Finish() {
    if (header_.names.empty()) {
      Fail(
          "nothing above names the markers; expected a line MARKER_NAMES and the names, or a row "
          "of column names NAME X, NAME Y, NAME Z, ..., separated by tabs");
    }
    if (marker_count_ && *marker_count_ != header_.names.size()) {
      Fail("above this line " + std::to_string(header_.names.size()) +
           " markers are named; NO_OF_MARKERS is " + std::to_string(*marker_count_));
    }
  }

  std::string_view text_;
  const std::string& source_;
  QtmHeader header_;
  std::set<std::string> keys_;
  std::optional<std::size_t> marker_count_;
};

}  // namespace

QtmHeader ReadQtmHeader(std::string_view text, const std::string& source) {
  return HeaderReader(text, source).Read();
}

bool IsQtmGap(std::string_view cell) {
  cell = Trim(cell);
  if (cell.size() > 4) return false;
  std::string lower(cell);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return lower.empty() || lower == "nan" || lower == "null";
}

}  // namespace elastocal
