// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the name of the library
class App;
}

namespace elastocal::cli {

/// Kind of value that an option takes.
enum class ValueKind { kNone, kNumber, kChoice, kFile, kFolder, kOther };

/// An option of a command, or an argument without dashes.
struct OptionWords {
  std::vector<std::string> names;     ///< "-o", "--output"; empty for an argument
  std::string value;                  ///< name of its value in the help: "FILE"; "" for a flag
  std::string range;                  ///< allowed range, if there is one: "2 to 1000"
  std::vector<std::string> choices;   ///< all allowed values, if there are few
  std::string help, standard, group;  ///< `standard` is the default value
  ValueKind kind = ValueKind::kNone;
  bool is_required = false, is_repeated = false;
};

struct CommandWords {
  std::string name, help, footer;
  std::vector<OptionWords> arguments, options;
};

/// All words of the program, for the manual page and for shells.
struct ProgramWords {
  std::string name, version, help;
  std::vector<std::pair<int, std::string>> exit_codes;
  std::vector<OptionWords> options;  ///< options without a command
  /// Options of every command, also contained in each command's list.
  std::vector<OptionWords> shared;
  std::vector<CommandWords> commands;  ///< without hidden ones
};

/// Reads the words from the definitions that parse the command line. Version and exit codes are
/// left to the caller.
ProgramWords ReadWords(const CLI::App& app);

}  // namespace elastocal::cli
