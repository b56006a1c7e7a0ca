#pragma once

#include <filesystem>
#include <fstream>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace elastocal {

/// Opens a table for reading. Throws InputError where there is no file or it cannot be read.
std::ifstream OpenTable(const std::filesystem::path& file);

/// The rows of a table of separated values: comma, semicolon or tab, as the first row has it; cells
/// may stand in double quotes; any line ends; a byte-order mark and empty lines at the end are
/// passed over. Reads on as rows are asked for, so that a file that is something else is refused
/// by its first lines, whatever its size.
class TableLines {
 public:
  /// The stream must outlive the new object; `source` names it in messages.
  TableLines(std::istream& stream, const std::string& source);
  ~TableLines();

  /// Reads the next row into `cells`, spaces around them removed; false at the end. Throws
  /// InputError naming file and line: NUL bytes, a line above 1 MiB, unfinished quotes, an empty
  /// line between rows.
  bool Next(std::vector<std::string>& cells);

  int line() const { return line_; }  ///< of the row read last
  char separator() const { return separator_; }

 private:
  class Lines;  // keeps libfccp out of this header

  bool NextLine(std::string_view& text);

  std::string source_;
  std::unique_ptr<Lines> lines_;
  int line_ = 0;
  char separator_ = '\0';
};

/// Splits a line at the separators outside double quotes; "" within quotes is one quote. False for
/// quotes that do not enclose a whole cell.
bool SplitCells(std::string_view line, char separator, std::vector<std::string>& cells);

/// A cell as a finite number. Throws InputError naming file, line and column for anything else.
double CellNumber(const std::string& cell, const std::string& column, const std::string& source,
                  int line);

/// A text as a cell of a table, in quotes where it needs them.
std::string MakeCell(const std::string& text);

}  // namespace elastocal
