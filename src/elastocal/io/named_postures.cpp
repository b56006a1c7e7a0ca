// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/named_postures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

struct PostureTableColumns {
  std::vector<std::array<int, 3>> markers;  ///< x, y, z of each
  int time = -1;
};

/// Finds the columns by their names and fills `postures`; nothing without a marker.
std::optional<PostureTableColumns> NameColumns(const Table& table, NamedPostures& postures) {
  const std::vector<std::string>& header = table.header();
  PostureTableColumns columns;
  const auto find = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    return at == header.end() ? -1 : static_cast<int>(at - header.begin());
  };
  std::set<int> taken;
  for (const std::string& name : header) {
    if (name.size() < 3 || !name.ends_with("_x")) continue;
    const std::string marker = name.substr(0, name.size() - 2);
    const std::array<int, 3> xyz = {find(name), find(marker + "_y"), find(marker + "_z")};
    if (xyz[1] < 0 || xyz[2] < 0) continue;
    columns.markers.push_back(xyz);
    postures.markers.push_back({marker, 0});
    taken.insert(xyz.begin(), xyz.end());
  }
  if (columns.markers.empty()) return std::nullopt;
  columns.time = std::max(find("t"), find("time"));
  for (int i = 0; i < static_cast<int>(header.size()); ++i) {
    if (i == columns.time || taken.contains(i) || table.CountsRows(i)) continue;
    postures.joints.push_back(header[static_cast<std::size_t>(i)]);
  }
  return columns;
}

/// Whether times are those of samples, and not of postures that are held.
bool AreSamples(const std::vector<double>& time) {
  constexpr double kLongest = 0.1;  // s between samples
  return time.size() > 1 && MedianInterval(time) < kLongest;
}

/// Why a table is no joint log; empty if it may be one.
std::string WhyNoLog(const ByteSource& source, const std::string& time_unit) {
  SourceStream stream(source);
  Table table(stream, source.name());
  const std::vector<std::string> header = table.header();
  const std::ptrdiff_t at = FindTime(header);
  if (at == std::ssize(header)) return "there is no column 't' or 'time'";
  if (!time_unit.empty() || !TimeUnitOfName(header[Size(at)])->empty()) return "";
  std::vector<double> time;
  while (table.Next()) {
    const std::optional<double> number = ParseNumber(table.Cell(static_cast<int>(at)));
    if (!number || !std::isfinite(*number)) return "";  // whoever reads the log says so
    time.push_back(*number);
  }
  if (MayBeSamples(time)) return "";
  return "most rows are " + FormatNumber(MedianInterval(time)) + " apart by the column " +
         Quote(header[Size(at)]) +
         ", too much for the samples of a joint log in s (if it is one, say the unit of its time: "
         "--time-unit ms)";
}

}  // namespace

std::ptrdiff_t FindTime(const std::vector<std::string>& header) {
  for (const char* name : {"t", "time"}) {
    const auto at = std::ranges::find(header, name);
    if (at != header.end()) return at - header.begin();
  }
  const auto named = [](const std::string& name) { return TimeUnitOfName(name).has_value(); };
  return std::ranges::find_if(header, named) - header.begin();
}

std::optional<NamedPostures> ReadNamedPostures(const ByteSource& source) {
  SourceStream stream(source);
  Table table(stream, source.name());
  NamedPostures postures;
  const std::optional<PostureTableColumns> columns = NameColumns(table, postures);
  if (!columns) return std::nullopt;
  std::vector<double> time;
  while (table.Next()) {
    ++postures.count;
    for (std::size_t m = 0; m < columns->markers.size(); ++m) {
      const auto& xyz = columns->markers[m];
      postures.markers[m].seen += std::none_of(
          xyz.begin(), xyz.end(), [&](int column) { return IsGap(table.Cell(column)); });
    }
    if (columns->time >= 0) time.push_back(table.Number(columns->time));
  }
  if (AreSamples(time)) return std::nullopt;
  return postures;
}

std::optional<NamedPostures> ReadColumnsAsTheyAre(const ByteSource& source,
                                                  const std::string& time_unit, std::string& why) {
  why = WhyNoLog(source, time_unit);
  if (why.empty()) return std::nullopt;
  SourceStream stream(source);
  Table table(stream, source.name());
  NamedPostures table_of;
  for (const std::string& name : table.header()) table_of.columns.push_back({name});
  if (table_of.columns.size() < 2) return std::nullopt;
  while (table.Next()) {
    ++table_of.count;
    for (std::size_t i = 0; i < table_of.columns.size(); ++i) {
      const std::string_view cell = table.Cell(static_cast<int>(i));
      if (IsGap(cell)) continue;
      NamedPostures::Column& column = table_of.columns[i];
      ++column.filled;
      const std::optional<double> number = ParseNumber(cell);
      if (!number) continue;
      column.least = column.numbers == 0 ? *number : std::min(column.least, *number);
      column.largest = column.numbers == 0 ? *number : std::max(column.largest, *number);
      ++column.numbers;
    }
  }
  if (table_of.count == 0) return std::nullopt;
  return table_of;
}

}  // namespace elastocal
