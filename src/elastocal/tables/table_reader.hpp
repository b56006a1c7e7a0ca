// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <istream>
#include <map>
#include <span>
#include <sstream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Opens a table for reading. Throws InputError like ReadFile.
std::istringstream OpenTable(const std::filesystem::path& file);

/// A text as a stream, without a copy of it; the text must outlive the stream.
class TextStream : private std::streambuf, public std::istream {
 public:
  explicit TextStream(std::string_view text);
};

/// The lines of a text, one by one. A line ends with LF or CR LF or, where the first line does so,
/// with CR. A byte-order mark is passed over. The text is read only as lines are asked for, so that
/// a large file of another kind is refused by its first lines.
class LineReader {
 public:
  /// The stream must outlive the new object; `source` names it in messages.
  LineReader(std::istream& stream, std::string source)
      : stream_(stream), source_(std::move(source)) {}

  /// Takes the next line, without its end; false at the end of the text. The line may be changed
  /// and stays where it is until the next call. Throws InputError naming file and line: NUL bytes,
  /// a line above 1 MiB.
  bool Next(std::span<char>& line);

  int line() const { return line_; }  ///< of the line read last, from 1
  const std::string& source() const { return source_; }

 private:
  bool Fill();
  void Begin();

  std::istream& stream_;
  std::string source_;
  std::string buffer_;     ///< a part of the text
  std::size_t begin_ = 0;  ///< beginning of the next line in `buffer_`
  char line_end_ = '\n';
  int line_ = 0;
};

enum class Quotes { kEnclose, kOrdinary };

/// Splits a line into cells at the separators and removes spaces around them. With Quotes::kEnclose
/// a cell may be enclosed in double quotes: separators in it are then text, and "" is one quote;
/// the line is changed in place. Returns false for quotes that do not enclose a whole cell. The
/// cells are views into the line.
bool SplitCells(std::span<char> line, char separator, Quotes quotes,
                std::vector<std::string_view>& cells);

/// A table of separated values with a header row: separated by comma, semicolon or tab, whichever
/// the header has most of. Empty lines above the first row and at the end are passed over.
class Table {
 public:
  /// Reads the header. The stream must outlive the new object; `source` names it in messages.
  /// Throws InputError if there is no header, and what Next throws.
  Table(std::istream& stream, const std::string& source);

  /// Reads the next row; false at the end. Throws InputError naming file and line: what LineReader
  /// refuses, unfinished quotes, an empty line between rows, a row that is not as long as the
  /// header.
  bool Next();

  /// A cell of the row read last, by column from 0.
  std::string_view Cell(int column) const { return cells_[static_cast<std::size_t>(column)]; }

  /// Whether a column has row numbers, as pandas writes them: it is the first one and has no name
  /// (or "Unnamed: 0"). Next throws if they are no whole numbers.
  bool CountsRows(int column) const;

  /// A cell as a finite number, with a decimal point or, where no comma separates, a decimal comma
  /// as all numbers then have. Throws InputError naming file, line and column for anything else.
  double Number(int column) const;

  const std::vector<std::string>& header() const { return header_; }
  const std::string& source() const { return lines_.source(); }
  int line() const { return lines_.line(); }  ///< of the row read last
  int row_count() const { return rows_; }     ///< read so far, without the header

  /// Throws InputError about the row read last, and about a column of it.
  [[noreturn]] void Fail(const std::string& what) const;
  [[noreturn]] void FailCell(int column, const std::string& what) const;

 private:
  bool NextCells();
  bool SplitLine(std::span<char> text);
  void CheckRowNumber() const;
  std::string_view WithPoint(int column) const;

  LineReader lines_;
  char separator_ = '\0';
  std::vector<std::string_view> cells_;
  std::vector<std::string> header_;
  int rows_ = 0;
  mutable char decimal_mark_ =
      '\0';  ///< decimal mark of the first number that has one, if the separator is no comma
  mutable std::string number_;
};

/// Meaning of column names: the number of a quantity, from 0, or kPassedOver. Several names may
/// mean one quantity.
using ColumnRoles = std::map<std::string, int>;
constexpr int kPassedOver = -1;

/// For each quantity its column, or -1 if there is none; row numbers (Table::CountsRows) are passed
/// over. Call it before the first row is read.
/// Throws InputError: two columns of one quantity; an unknown column, with the nearest known name
/// and `advice`; numbers or a comment where the header should be.
std::vector<int> FindColumns(const Table& table, const ColumnRoles& roles, std::size_t quantities,
                             const std::string& advice);

/// Whether the columns of a group, as FindColumns gives them, are all there; false if none is. If
/// only some are, throws InputError naming the first that is missing. `names` are the expected
/// names and `owner` says to what they belong: "marker 'A'".
bool HasGroup(const Table& table, std::span<const int> columns, std::span<const std::string> names,
              const std::string& owner);

/// Adds the time in a column of the row read last. Throws InputError if it is not above the last
/// one.
void AppendTime(const Table& table, int column, std::vector<double>& time);

/// Numbers that were read row after row, as a matrix with `rows` rows (one or more).
Eigen::MatrixXd StackRows(const std::vector<double>& numbers, std::size_t rows);

}  // namespace elastocal
