// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// A text as a cell that Table reads back as the same text: in double quotes if it has separators,
/// quotes, or spaces at its ends. Throws InputError for a text with a line end, which no cell can
/// hold.
std::string MakeCell(std::string_view text);

/// A table as text, written cell by cell: cells separated by commas, lines ended by \n.
class TableWriter {
 public:
  void Add(std::string_view text);
  void Add(double value);                     ///< with all digits; NaN is an empty cell
  void AddFixed(double value, int decimals);  ///< with so many decimals; NaN is an empty cell
  void EndRow();

  const std::string& text() const { return text_; }

 private:
  void Separate();

  std::string text_;
  bool row_begins_ = true;
};

}  // namespace elastocal
