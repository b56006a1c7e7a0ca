// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace elastocal::cli {

struct CommonOptions;

/// Result of a command: the files it writes and the texts it prints.
struct CommandResult {
  std::map<std::string, std::string> files;  ///< contents by name
  std::string json;                          ///< text for --json
  std::string text;
  std::vector<std::string> warnings, errors;
  bool fine = false;  ///< true: exit code 0; false: 4

  /// Prints text, warnings and errors.
  void Print(const CommonOptions& options) const;

  int exit_code() const;
};

}  // namespace elastocal::cli
