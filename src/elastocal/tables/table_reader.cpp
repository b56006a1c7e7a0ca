// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/table_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kLongestLine = 1u << 20;
constexpr std::size_t kBlock = 1u << 16;

/// The separator that occurs most often in the header, outside quotes.
char FindSeparator(std::span<const char> header) {
  constexpr std::array kSeparators = {',', ';', '\t'};
  std::array<int, kSeparators.size()> count{};
  bool quoted = false;
  for (const char c : header) {
    quoted ^= c == '"';
    for (std::size_t i = 0; i < kSeparators.size(); ++i) {
      count[i] += !quoted && c == kSeparators[i] ? 1 : 0;
    }
  }
  return kSeparators[static_cast<std::size_t>(std::max_element(count.begin(), count.end()) -
                                              count.begin())];
}

bool IsBlank(std::span<const char> line) { return Trim({line.data(), line.size()}).empty(); }

/// Takes a quoted cell, whose opening quote is at `at`: removes the quotes from its text in place
/// and returns the place where the line goes on, or null if the quotes do not end.
char* TakeQuoted(char* at, char* end, std::string_view& cell) {
  char* const begin = ++at;
  char* to = begin;
  for (; at != end; ++at) {
    if (*at == '"' && (at + 1 == end || at[1] != '"')) {
      cell = std::string_view(begin, static_cast<std::size_t>(to - begin));
      return std::find_if(at + 1, end, [](char c) { return c != ' '; });
    }
    if (*at == '"') ++at;
    *to++ = *at;
  }
  return nullptr;
}

}  // namespace

std::istringstream OpenTable(const std::filesystem::path& file) {
  return std::istringstream(ReadFile(file));
}

TextStream::TextStream(std::string_view text) : std::istream(static_cast<std::streambuf*>(this)) {
  // A stream buffer wants to be able to write, but an input stream does not.
  char* const begin = const_cast<char*>(text.data());
  setg(begin, begin, begin + text.size());
}

/// Reads a further block of the text; false if there is none. The next line moves to the
/// beginning of the buffer.
bool LineReader::Fill() {
  buffer_.erase(0, begin_);
  begin_ = 0;
  const std::size_t held = buffer_.size();
  buffer_.resize(held + kBlock);
  stream_.read(buffer_.data() + held, static_cast<std::streamsize>(kBlock));
  if (stream_.bad()) throw InputError(source_ + ": cannot be read");
  buffer_.resize(held + static_cast<std::size_t>(stream_.gcount()));
  const std::size_t nul = buffer_.find('\0', held);
  if (nul != std::string::npos) {
    const auto before = buffer_.begin() + static_cast<std::ptrdiff_t>(nul);
    const auto lines = std::count(buffer_.begin(), before, line_end_);
    throw InputError(Place(source_, line_ + 1 + static_cast<int>(lines)) +
                     "found a NUL byte; a table (text) was expected");
  }
  return buffer_.size() > held;
}

void LineReader::Begin() {
  Fill();
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (buffer_.starts_with(kByteOrderMark)) begin_ = kByteOrderMark.size();
  const std::size_t end = buffer_.find_first_of("\r\n");
  if (end != std::string::npos && buffer_.substr(end, 2) != "\r\n") line_end_ = buffer_[end];
}

bool LineReader::Next(std::span<char>& line) {
  InterruptionPoint();
  if (line_ == 0 && buffer_.empty()) Begin();
  std::size_t searched = begin_, end = 0;
  while ((end = buffer_.find(line_end_, searched)) == std::string::npos) {
    const std::size_t held = buffer_.size() - begin_;
    if (held > kLongestLine) break;
    if (!Fill()) {
      if (held == 0) return false;
      break;
    }
    searched = held;
  }
  ++line_;
  end = std::min(end, buffer_.size());
  if (end - begin_ > kLongestLine) {
    throw InputError(Place(source_, line_) + "a line of more than 1 MiB");
  }
  line = std::span(buffer_).subspan(begin_, end - begin_);
  begin_ = std::min(end + 1, buffer_.size());
  if (!line.empty() && line.back() == '\r') line = line.first(line.size() - 1);
  return true;
}

bool SplitCells(std::span<char> line, char separator, Quotes quotes,
                std::vector<std::string_view>& cells) {
  cells.clear();
  char* at = line.data();
  char* const end = at + line.size();
  for (;; ++at) {
    char* stop = nullptr;
    while (at != end && *at == ' ') ++at;
    if (quotes == Quotes::kEnclose && at != end && *at == '"') {
      stop = TakeQuoted(at, end, cells.emplace_back());
      if (stop == nullptr || (stop != end && *stop != separator)) return false;
    } else {
      stop = std::find(at, end, separator);
      cells.push_back(Trim({at, static_cast<std::size_t>(stop - at)}));
    }
    if (stop == end) return true;
    at = stop;
  }
}

Table::Table(std::istream& stream, const std::string& source) : lines_(stream, source) {
  if (!NextCells()) throw InputError(source + ": is empty; a header row was expected");
  header_.assign(cells_.begin(), cells_.end());
  for (const std::string& name : header_) RequireUtf8(name, source, line());
}

bool Table::NextCells() {
  std::span<char> text;
  if (!lines_.Next(text)) return false;
  if (IsBlank(text)) {
    const int first_empty = line();
    while (lines_.Next(text)) {
      if (IsBlank(text)) continue;
      if (rows_ == 0) return SplitLine(text);
      throw InputError(Place(source(), first_empty) + "an empty line above further rows");
    }
    return false;
  }
  return SplitLine(text);
}

bool Table::SplitLine(std::span<char> text) {
  if (separator_ == '\0') separator_ = FindSeparator(text);
  if (SplitCells(text, separator_, Quotes::kEnclose, cells_)) return true;
  Fail("quotes that do not enclose a whole cell");
}

bool Table::Next() {
  if (!NextCells()) return false;
  ++rows_;
  if (cells_.size() == header_.size()) {
    if (CountsRows(0)) CheckRowNumber();
    return true;
  }
  // A decimal comma splits a number in two.
  const bool commas = separator_ == ',' && 2 * cells_.size() >= 3 * header_.size();
  Fail("found " + std::to_string(cells_.size()) + " cells; the header has " +
       std::to_string(header_.size()) + (commas ? "; decimal commas?" : ""));
}

bool Table::CountsRows(int column) const {
  return column == 0 && header_.size() > 1 &&
         (header_.front().empty() || header_.front() == "Unnamed: 0");
}

void Table::CheckRowNumber() const {
  const std::optional<double> number = ParseNumber(Cell(0));
  if (number && *number >= 0.0 && *number == std::floor(*number)) return;
  Fail("the first column has no name, and is not passed over as row numbers: found " +
       Quote(Cell(0)));
}

/// The number in a cell with a decimal point. If the separator is not a comma, all numbers may have
/// decimal commas.
std::string_view Table::WithPoint(int column) const {
  const std::string_view cell = Cell(column);
  const std::size_t at = separator_ == ',' ? std::string_view::npos : cell.find_first_of(".,");
  if (at == std::string_view::npos) return cell;
  if (decimal_mark_ == '\0') decimal_mark_ = cell[at];
  if (cell[at] != decimal_mark_) {
    FailCell(column, "found " + Quote(cell) + "; a number with a decimal " +
                         (decimal_mark_ == ',' ? "comma" : "point") +
                         ", as others above, was expected");
  }
  if (cell[at] == '.') return cell;
  number_ = cell;
  number_[at] = '.';
  return number_;
}

double Table::Number(int column) const {
  const std::string_view cell = Cell(column);
  if (const std::optional<double> number = ParseNumber(WithPoint(column))) return *number;
  FailCell(column, "found " + (cell.empty() ? "nothing" : Quote(cell)) +
                       "; a finite number was expected" +
                       (cell.find(',') == std::string_view::npos ? "" : ", with a decimal point"));
}

void Table::Fail(const std::string& what) const {
  throw InputError(Place(source(), line()) + what);
}

void Table::FailCell(int column, const std::string& what) const {
  Fail("column " + Quote(header_[static_cast<std::size_t>(column)]) + ": " + what);
}

std::vector<int> FindColumns(const Table& table, const ColumnRoles& roles, std::size_t quantities,
                             const std::string& advice) {
  std::vector<int> columns(quantities, -1);
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    const std::string& name = table.header()[i];
    const auto role = roles.find(name);
    if (role == roles.end() && table.CountsRows(static_cast<int>(i))) continue;
    if (role == roles.end() && name.empty()) {
      table.Fail("empty column name, cell " + std::to_string(i + 1));
    }
    if (role == roles.end() && i == 0 && name.starts_with('#')) {
      table.Fail("found " + Quote(name) +
                 " in the first row, which names the columns; lines of comment are not taken");
    }
    if (role == roles.end() && ParseNumber(name)) {
      table.Fail("found the number " + Quote(name) +
                 " in the first row; a header row with the names of the columns was expected");
    }
    if (role == roles.end()) {
      std::vector<std::string> known;
      for (const auto& [text, quantity] : roles) known.push_back(text);
      table.Fail("unknown column " + Quote(name) + DidYouMean(name.substr(0, 60), known) + " (" +
                 advice + ")");
    }
    if (role->second == kPassedOver) continue;
    int& column = columns[static_cast<std::size_t>(role->second)];
    if (column >= 0) {
      const std::string& first = table.header()[static_cast<std::size_t>(column)];
      table.Fail(first == name ? "the column " + Quote(name) + " comes twice"
                               : "the columns " + Quote(first) + " and " + Quote(name) +
                                     " stand for the same (" + advice + ")");
    }
    column = static_cast<int>(i);
  }
  return columns;
}

bool HasGroup(const Table& table, std::span<const int> columns, std::span<const std::string> names,
              const std::string& owner) {
  const auto missing = std::find(columns.begin(), columns.end(), -1);
  if (missing == columns.end()) return true;
  const auto there = std::find_if(columns.begin(), columns.end(), [](int c) { return c >= 0; });
  if (there == columns.end()) return false;
  const std::string& name = names[static_cast<std::size_t>(missing - columns.begin())];
  table.Fail("the column " + Quote(name) + " of " + owner + " is missing, but " +
             Quote(table.header()[static_cast<std::size_t>(*there)]) + " is there");
}

void AppendTime(const Table& table, int column, std::vector<double>& time) {
  const double value = table.Number(column);
  if (!time.empty() && !(value > time.back())) {
    table.FailCell(column, "found " + FormatNumber(value) + " after " + FormatNumber(time.back()) +
                               "; the time must increase from row to row");
  }
  time.push_back(value);
}

Eigen::MatrixXd StackRows(const std::vector<double>& numbers, std::size_t rows) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMajor> read(numbers.data(), static_cast<Eigen::Index>(rows),
                                        static_cast<Eigen::Index>(numbers.size() / rows));
  // Some rows at a time stay in the cache while they become columns.
  constexpr Eigen::Index kRows = 64;
  Eigen::MatrixXd stacked(read.rows(), read.cols());
  for (Eigen::Index row = 0; row < read.rows(); row += kRows) {
    const Eigen::Index count = std::min(kRows, read.rows() - row);
    stacked.middleRows(row, count) = read.middleRows(row, count);
  }
  return stacked;
}

}  // namespace elastocal
