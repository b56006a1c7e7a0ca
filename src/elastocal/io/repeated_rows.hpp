// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// Finds rows that repeat a row above them in every cell, also in another table with the same
/// columns.
class RepeatedRows {
 public:
  /// Takes the row that was read last.
  void Take(const Table& table);

  /// "left.csv:42: this row and 39 more repeat ..."; empty if no row is repeated.
  std::string Warning() const;

 private:
  std::map<std::vector<std::string>, std::string> first_;  // places by header and cells
  std::string repeated_, repeats_;                         // places of the first one
  int count_ = 0;
};

}  // namespace elastocal
