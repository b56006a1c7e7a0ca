#include "elastocal/io/qtm_frames.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kMetresPerMm = 1e-3;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::size_t CountTabs(std::string_view row) {
  return static_cast<std::size_t>(std::count(row.begin(), row.end(), '\t'));
}

/// Columns before those of the markers, where no row names them: they are never empty, and the
/// cells of a marker are all empty or all full.
std::size_t InferLeadingColumns(std::string_view row, std::size_t markers) {
  std::size_t full = 0;
  const std::size_t cells = CountTabs(row) + 1;
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t tab = std::min(row.find('\t'), row.size());
    full += Trim(row.substr(0, tab)).empty() ? 0 : 1;
    row.remove_prefix(std::min(tab + 1, row.size()));
  }
  const std::size_t leading = full % 3;
  const std::size_t known = leading + 3 * markers;
  if (cells == known || cells == known + 1) return leading;
  // Something is wrong in this row; what, is said when it is read.
  return cells > 3 * markers ? std::min<std::size_t>(cells - 3 * markers, 2) : 0;
}

/// Reads the frames of a text whose header is known.
class FrameReader {
 public:
  FrameReader(std::string_view text, const QtmHeader& header, const std::string& source)
      : header_(header), source_(source), line_(header.data_line) {
    rest_ = text.substr(header.data_begin);
    // Not tabs: a marker that was not seen may end the last row.
    rest_ = rest_.substr(0, rest_.find_last_not_of(" \r\n") + 1);
  }

  QtmFrames Read() {
    if (rest_.empty()) throw InputError(source_ + ": no frame below the header");
    const std::size_t width = 3 * header_.names.size();
    // A row has a byte for each of its cells at least: this bounds what a file can allocate.
    const std::size_t lines =
        1 + static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n'));
    const std::size_t frames = std::min(lines, rest_.size() / width + 1);
    QtmFrames result;
    result.positions.resize(static_cast<Eigen::Index>(frames), static_cast<Eigen::Index>(width));
    for (std::size_t i = 0; i < lines; ++i, ++line_) {
      TakeRow();
      if (i == 0) FindLayout();
      ReadRow(static_cast<Eigen::Index>(i), result.positions);
    }
    if (header_.frames && *header_.frames != lines) {
      throw InputError(source_ + ": found " + std::to_string(lines) + " frames; NO_OF_FRAMES is " +
                       std::to_string(*header_.frames) +
                       " (correct it if frames were left out on purpose)");
    }
    result.leading = std::move(leading_);
    result.leading_names = std::move(leading_names_);
    return result;
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(Place(source_, line_) + message);
  }

  void TakeRow() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    row_ = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (row_.ends_with('\r')) row_.remove_suffix(1);
  }

  void FindLayout() {
    const std::size_t markers = header_.names.size();
    if (header_.leading_columns) {
      leading_names_ = *header_.leading_columns;
      leading_.resize(leading_names_.size());
    } else {
      leading_.resize(InferLeadingColumns(row_, markers));
      if (leading_.size() == 2) leading_names_ = {"Frame", "Time"};
    }
    const std::size_t expected = leading_.size() + 3 * markers;
    tabs_ = CountTabs(row_);
    // A tab at the end of every row is no further column.
    const bool ends_with_tab = tabs_ == expected && row_.ends_with('\t');
    if (tabs_ + 1 == expected || ends_with_tab) return;
    Fail("found " + std::to_string(tabs_ + 1) + " cells; " + std::to_string(expected) +
         " were expected: " + std::to_string(leading_.size()) +
         " (Frame, Time) and 3 for each of " + std::to_string(markers) + " markers");
  }

  void ReadRow(Eigen::Index frame, Eigen::MatrixXd& positions) {
    if (CountTabs(row_) != tabs_) {
      Fail("found " + std::to_string(CountTabs(row_) + 1) + " cells; the rows above have " +
           std::to_string(tabs_ + 1));
    }
    at_ = row_.data();
    for (std::vector<double>& column : leading_) {
      const char* begin = at_;
      column.push_back(NextCell());
      if (std::isnan(column.back())) FailCell(begin, "a number");
    }
    for (Eigen::Index i = 0; i < positions.cols(); i += 3) {
      const char* begin = at_;
      double x = NextCell(), y = NextCell(), z = NextCell();
      const int missing = std::isnan(x) + std::isnan(y) + std::isnan(z);
      if (missing == 1 || missing == 2) {
        FailCell(begin, "X, Y and Z, or none of them for a marker that was not seen");
      }
      if (x == 0.0 && y == 0.0 && z == 0.0) x = y = z = kNaN;
      positions(frame, i) = kMetresPerMm * x;
      positions(frame, i + 1) = kMetresPerMm * y;
      positions(frame, i + 2) = kMetresPerMm * z;
    }
    if (at_ < row_.data() + row_.size()) FailCell(at_, "the end of the line");
  }

  /// The number in the next cell, NaN for a gap. There is a cell: the tabs have been counted.
  double NextCell() {
    const char* const end = row_.data() + row_.size();
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at_, end, value);
    if (error == std::errc() && (stop == end || *stop == '\t') && std::isfinite(value)) {
      at_ = stop == end ? end : stop + 1;
      return value;
    }
    const char* tab = std::find(at_, end, '\t');
    const std::string_view cell(at_, static_cast<std::size_t>(tab - at_));
    const char* const begin = at_;
    at_ = tab == end ? end : tab + 1;
    if (IsQtmGap(cell)) return kNaN;
    const std::optional<double> number = ParseNumber(cell);
    if (!number) FailCell(begin, "a number with a decimal point");
    return *number;
  }

  [[noreturn]] void FailCell(const char* begin, const std::string& expected) const {
    const std::string_view before(row_.data(), static_cast<std::size_t>(begin - row_.data()));
    const std::size_t column = CountTabs(before);
    const std::string_view cell = row_.substr(before.size());
    Fail("column " + std::to_string(column + 1) + ColumnName(column) + ": found " +
         Quote(Trim(cell.substr(0, cell.find('\t')))) + "; expected " + expected);
  }

  /// " (NAME X)", or nothing where the column has no name.
  std::string ColumnName(std::size_t column) const {
    if (column < leading_.size()) {
      return leading_names_.empty() ? "" : " (" + leading_names_[column] + ")";
    }
    const std::size_t coordinate = column - leading_.size();
    if (coordinate / 3 >= header_.names.size()) return "";
    return " (" + header_.names[coordinate / 3] + " " + "XYZ"[coordinate % 3] + ")";
  }

  const QtmHeader& header_;
  const std::string& source_;
  std::string_view rest_, row_;
  const char* at_ = nullptr;  ///< in row_
  int line_ = 1;
  std::size_t tabs_ = 0;  ///< in each row
  std::vector<std::vector<double>> leading_;
  std::vector<std::string> leading_names_;
};

}  // namespace

QtmFrames ReadQtmFrames(std::string_view text, const QtmHeader& header, const std::string& source) {
  return FrameReader(text, header, source).Read();
}

}  // namespace elastocal
