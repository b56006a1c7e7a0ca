// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/table_writer.hpp"

#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

std::string MakeCell(std::string_view text) {
  if (text.find_first_of("\r\n") != std::string_view::npos) {
    throw InputError("a table cannot hold the name " + Quote(text) + ", which has a line end");
  }
  if (text.find_first_of(",;\t\"") == std::string_view::npos && Trim(text) == text)
    return std::string(text);
  std::string cell = "\"";
  for (const char c : text) cell.append(c == '"' ? 2 : 1, c);
  return cell + "\"";
}

void TableWriter::Separate() {
  if (!row_begins_) text_ += ',';
  row_begins_ = false;
}

void TableWriter::Add(std::string_view text) {
  Separate();
  text_ += MakeCell(text);
}

void TableWriter::Add(double value) {
  Separate();
  if (!std::isnan(value)) AppendNumber(value, text_);
}

void TableWriter::AddFixed(double value, int decimals) {
  Separate();
  if (!std::isnan(value)) AppendFixed(value, decimals, text_);
}

void TableWriter::EndRow() {
  InterruptionPoint();
  text_ += '\n';
  row_begins_ = true;
}

}  // namespace elastocal
