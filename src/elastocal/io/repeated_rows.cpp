// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/repeated_rows.hpp"

#include <utility>

#include <fmt/format.h>

namespace elastocal {

void RepeatedRows::Take(const Table& table) {
  std::vector<std::string> row = table.header();
  const int columns = static_cast<int>(row.size());
  for (int column = 0; column < columns; ++column) row.emplace_back(table.Cell(column));
  const std::string place = fmt::format("{}:{}", table.source(), table.line());
  const auto [first, is_new] = first_.emplace(std::move(row), place);
  if (is_new) return;
  if (count_ == 0) {
    repeats_ = place;
    repeated_ = first->second;
  }
  ++count_;
}

std::string RepeatedRows::Warning() const {
  if (count_ == 0) return "";
  const std::string counts =
      "counts as an independent measurement, which it is not: standard deviations come out too "
      "small";
  if (count_ == 1) {
    return fmt::format("{}: this row repeats {} in every cell; it {}", repeats_, repeated_, counts);
  }
  return fmt::format(
      "{}: this row and {} more repeat rows above them in every cell (this one {}); each {}",
      repeats_, count_ - 1, repeated_, counts);
}

}  // namespace elastocal
