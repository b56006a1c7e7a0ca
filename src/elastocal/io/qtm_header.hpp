#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elastocal {

/// What stands above the frames of a Qualisys 3-D TSV.
struct QtmHeader {
  std::vector<std::string> names;     ///< of the markers, one or more
  double rate_hz = 0.0;               ///< 0 where the file does not say
  std::optional<std::size_t> frames;  ///< how many there should be, where the file says so
  /// The columns before those of the markers, "Frame" and "Time", where a row names the columns.
  std::optional<std::vector<std::string>> leading_columns;
  std::size_t data_begin = 0;  ///< where the first frame begins in the text
  int data_line = 1;           ///< and its line
};

/// Reads the lines `KEY<tab>value` and the row of column names `[Frame] [Time] NAME X ...`; either
/// may be absent, but one of them has to name the markers. Keys without meaning here are passed
/// over. Throws InputError naming file, line and column.
QtmHeader ReadQtmHeader(std::string_view text, const std::string& source);

/// Whether a cell stands for a coordinate that was not measured: empty, NaN or NULL.
bool IsQtmGap(std::string_view cell);

}  // namespace elastocal
