// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/decimal_numbers.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

/// The header above the frames: lines `KEY<tab>value` and a row of column names `[Frame] [Time]
/// [SMPTE] NAME X ...`. Either may be absent, but one of them has to name the markers.
struct QtmHeader {
  /// Of the markers, one or more; empty for those without a name, whose columns are passed over.
  std::vector<std::string> names;
  double rate_hz = 0.0;  ///< 0 where the file does not say, or the clock is another's (EXT)
  std::optional<std::size_t> frames;  ///< how many there should be, where the file says so
  /// The columns before those of the markers, of "Frame", "Time" and "SMPTE" (a time code, which is
  /// passed over), where a row names the columns.
  std::optional<std::vector<std::string>> leading_columns;
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

/// Reads up to the first frame, whose cells are then in the lines; there may be none. Throws
/// InputError naming the line.
QtmHeader ReadQtmHeader(QtmLines& lines);

/// Whether a text begins like a Qualisys TSV: with `KEY<tab>`, or with names of columns. A table of
/// joints may begin with the column Time as well.
bool BeginsLikeQtmTsv(std::string_view head);

/// Whether it surely begins so, where tables are expected, whose first column may be called Time or
/// t.
bool IsSurelyQtmTsv(std::string_view head);

}  // namespace elastocal
