// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/decimal_numbers.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

/// The separator of a text (comma, semicolon or tab): the one with which a line begins, in the
/// first such line; else the first one in the text; else a comma.
inline char FindFirstSeparator(std::string_view text) {
  constexpr std::string_view kSeparators = ",;\t";
  const std::size_t found = text.find_first_of(kSeparators);
  for (std::size_t at = 0; at < text.size(); at = text.find_first_of("\r\n", at) + 1) {
    if (kSeparators.find(text[at]) != std::string_view::npos) return text[at];
    if (text.find_first_of("\r\n", at) == std::string_view::npos) break;
  }
  return found == std::string_view::npos ? ',' : text[found];
}

inline char FindFirstSeparator(const ByteSource& source) {
  std::array<char, 4096> head{};
  return FindFirstSeparator(std::string_view(head.data(), source.Read(0, head)));
}

/// Whether the text ends within a line. The last row of a file of cameras may then be cut off, even
/// within a number, and is passed over.
inline bool EndsWithinALine(const ByteSource& source) {
  std::array<char, 1> last{'\n'};
  if (source.size() > 0) source.Read(source.size() - 1, last);
  return last[0] != '\n' && last[0] != '\r';
}

/// The note about such a row.
constexpr const char* kCutRow =
    "the last row is passed over: no line end follows it, so that it may be cut off";

/// Reads a text of separated values line by line, as programs of cameras export it: lines have
/// different lengths, and the meaning of a line depends on its place. If the separator is not a
/// comma, all numbers may have decimal commas.
class CsvLines {
 public:
  CsvLines(const ByteSource& source, char separator)
      : stream_(source), reader_(stream_, source.name()), separator_(separator) {}

  bool Next() {
    std::span<char> line;
    if (!reader_.Next(line)) return false;
    SplitCells(line, separator_, separator_ == '\t' ? Quotes::kOrdinary : Quotes::kEnclose, cells_);
    return true;
  }

  /// The next line, which must be there; `what` it should be.
  void Expect(const std::string& what) {
    if (!Next()) throw InputError(reader_.source() + ": the file ends before " + what);
  }

  const std::vector<std::string_view>& cells() const { return cells_; }
  std::size_t count() const { return cells_.size(); }
  int line() const { return reader_.line(); }
  bool blank() const {
    return std::all_of(cells_.begin(), cells_.end(), [](auto cell) { return cell.empty(); });
  }
  /// Empty beyond the end of the line.
  std::string_view Cell(std::size_t i) const {
    return i < cells_.size() ? cells_[i] : std::string_view();
  }
  /// A name, which must be UTF-8.
  std::string Name(std::size_t i) const {
    std::string name(Cell(i));
    RequireUtf8(name, reader_.source(), reader_.line());
    return name;
  }

  /// A finite number as the file writes them.
  std::optional<double> Parse(std::string_view cell) {
    return separator_ == ',' ? ParseNumber(cell) : numbers_.Parse(cell);
  }

  /// A finite number; NaN for a gap. Throws InputError for anything else.
  double NumberOrGap(std::size_t i) {
    const std::string_view cell = Cell(i);
    if (const std::optional<double> number = Parse(cell)) return *number;
    if (!IsGap(cell)) FailNumber(i, ", or nothing");
    return kNaN;
  }
  double Number(std::size_t i) {
    if (const std::optional<double> number = Parse(Cell(i))) return *number;
    FailNumber(i, "");
  }

  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(reader_.source(), std::max(reader_.line(), 1)) + message);
  }
  [[noreturn]] void FailCell(std::size_t i, const std::string& expected) const {
    Fail("column " + std::to_string(i + 1) + ": found " + Quote(Cell(i)) + "; " + expected +
         " was expected");
  }

  /// X, Y and Z in three cells; all NaN for three gaps. Throws InputError for one or two gaps.
  std::array<double, 3> Position(std::size_t i) {
    std::array<double, 3> position{};
    int missing = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      position[k] = NumberOrGap(i + k);
      missing += position[k] != position[k] ? 1 : 0;
    }
    if (missing == 1 || missing == 2) {
      FailCell(i, "X, Y and Z, or none of them for a marker that was not seen,");
    }
    return position;
  }

 private:
  [[noreturn]] void FailNumber(std::size_t i, const std::string& end) const {
    FailCell(i, numbers_.expected() + end);
  }

  SourceStream stream_;
  LineReader reader_;
  char separator_;
  DecimalNumbers numbers_;
  std::vector<std::string_view> cells_;
};

/// Checks that frame numbers or times increase regularly: each is `step` after the last one, up to
/// `tolerance`.
class Steps {
 public:
  Steps(std::string column, double step, double tolerance)
      : column_(std::move(column)), step_(step), tolerance_(tolerance) {}

  void Check(const CsvLines& lines, double value) {
    // Times are rounded: the sum must not go astray either.
    if (count_ > 0 &&
        !(std::abs(value - last_ - step_) <= tolerance_ &&
          std::abs(value - first_ - step_ * count_) <= tolerance_ + 1e-4 * step_ * count_)) {
      lines.Fail(column_ + ": found " + FormatNumber(value) + " after " + FormatNumber(last_) +
                 "; a step of " + FormatNumber(step_) +
                 " was expected (frames were left out, or the rate is another)");
    }
    if (count_ == 0) first_ = value;
    last_ = value;
    count_ += 1.0;
  }

 private:
  std::string column_;
  double step_, tolerance_;
  double first_ = 0.0, last_ = 0.0, count_ = 0.0;
};

}  // namespace elastocal
