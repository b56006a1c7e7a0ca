#include "elastocal/report/csv_columns.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/report/encoding.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> Cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<std::string_view> Lines(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
  }
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

std::optional<double> Number(const std::string& cell) {
  double value = 0.0;
  const char* end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

Json Column(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
  Json numbers = Json::array();
  for (const auto& row : rows) {
    const std::optional<double> value = Number(row[column]);
    if (!value && !row[column].empty()) {
      Json texts = Json::array();
      for (const auto& each : rows) texts.push_back(each[column]);
      return texts;
    }
    numbers.push_back(value && std::isfinite(*value) ? Json(Rounded(*value, 6)) : Json(nullptr));
  }
  return numbers;
}

}  // namespace

nlohmann::ordered_json ReadCsvColumns(const std::string& file, const std::string& text,
                                      std::size_t most_rows, std::size_t& rows) {
  const std::vector<std::string_view> lines = Lines(text);
  if (lines.empty()) throw InputError(file + ": is empty; expected a table with a row of names");
  const std::vector<std::string> names = Cells(lines[0]);
  rows = lines.size() - 1;
  const std::size_t taken = std::min(rows, most_rows);
  std::vector<std::vector<std::string>> kept;
  for (std::size_t k = 0; k < taken; ++k) {
    const std::size_t row = taken < 2 ? k : k * (rows - 1) / (taken - 1);
    kept.push_back(Cells(lines[row + 1]));
    if (kept.back().size() == names.size()) continue;
    throw InputError(file + ":" + std::to_string(row + 2) + ": has " +
                     std::to_string(kept.back().size()) + " cells; expected " +
                     std::to_string(names.size()) + ", as in the row of names");
  }
  Json columns = Json::object();
  for (std::size_t c = 0; c < names.size(); ++c) columns[names[c]] = Column(kept, c);
  return columns;
}

}  // namespace elastocal
