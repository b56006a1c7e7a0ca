// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/csv_columns.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

nlohmann::ordered_json ColumnJson(const std::vector<std::string>& cells) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  for (const std::string& cell : cells) {
    const std::optional<double> number = ParseNumber(cell);
    if (!number && !IsGap(cell) && cell != "inf" && cell != "-inf") return cells;
    numbers.push_back(number ? nlohmann::ordered_json(Rounded(*number, 6))
                             : nlohmann::ordered_json(nullptr));
  }
  return numbers;
}

}  // namespace

nlohmann::ordered_json ReadCsvColumns(const std::string& file, const std::string& text,
                                      std::size_t most_rows, std::size_t& rows) {
  TextStream all(text);
  Table counted(all, file);
  while (counted.Next()) {
  }
  rows = static_cast<std::size_t>(counted.row_count());

  TextStream again(text);
  Table table(again, file);
  std::vector<std::vector<std::string>> columns(table.header().size());
  const std::size_t taken = std::min(rows, most_rows);
  for (std::size_t k = 0; k < taken; ++k) {
    const std::size_t row = taken < 2 ? k : k * (rows - 1) / (taken - 1);
    while (static_cast<std::size_t>(table.row_count()) <= row && table.Next()) {
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      columns[c].emplace_back(table.Cell(static_cast<int>(c)));
    }
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t c = 0; c < columns.size(); ++c) json[table.header()[c]] = ColumnJson(columns[c]);
  return json;
}

}  // namespace elastocal
