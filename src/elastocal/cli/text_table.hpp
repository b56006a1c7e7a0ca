// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace elastocal::cli {

/// A table for a terminal: the first column is aligned to the left, the others to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  void Add(std::vector<std::string> row);
  /// The table with rows indented by two spaces, each ended by a line feed.
  std::string Render() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// The first `most` of these words, and the number of the others: "a, b and 3 more".
std::string FirstOf(const std::vector<std::string>& words, std::size_t most);

}  // namespace elastocal::cli
