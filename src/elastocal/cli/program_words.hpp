// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the name of the library
class App;
}

namespace elastocal::cli {

/// What an option wants to have after it.
enum class ValueKind { kNone, kNumber, kChoice, kFile, kFolder, kOther };

/// An option of a command, or an argument that has no dashes.
struct OptionWords {
  std::vector<std::string> names;     ///< "-o", "--output"; empty for an argument
  std::string value;                  ///< how the help calls its value: "FILE"; "" for a flag
  std::string range;                  ///< what is allowed, where that is a range: "2 to 1000"
  std::vector<std::string> choices;   ///< all values that are allowed, where these are few
  std::string help, standard, group;  ///< `standard`: the value that it has when it is not given
  ValueKind kind = ValueKind::kNone;
  bool is_required = false, is_repeated = false;
};

struct CommandWords {
  std::string name, help, footer;
  std::vector<OptionWords> arguments, options;
};

/// All words that the program knows, for the manual and for shells.
struct ProgramWords {
  std::string name, version, help;
  std::vector<std::pair<int, std::string>> exit_codes;
  std::vector<OptionWords> options;    ///< without a command
  std::vector<OptionWords> shared;     ///< of every command; each command's list has them too
  std::vector<CommandWords> commands;  ///< but for hidden ones
};

/// Reads them from the definitions that parse the command line. Version and exit codes are left to
/// the caller.
ProgramWords ReadWords(const CLI::App& app);

}  // namespace elastocal::cli
