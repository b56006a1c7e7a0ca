// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace elastocal::cli {

struct CommonOptions;

/// What a command has found: what it writes and what it says.
struct CommandResult {
  std::map<std::string, std::string> files;  ///< text by name
  std::string json;                          ///< for --json
  std::string text;
  std::vector<std::string> warnings, errors;
  bool fine = false;  ///< exit code 0, else 4

  /// Prints text, warnings and errors.
  void Print(const CommonOptions& options) const;

  int exit_code() const;
};

}  // namespace elastocal::cli
