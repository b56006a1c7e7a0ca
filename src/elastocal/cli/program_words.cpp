// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/program_words.hpp"

#include <algorithm>
#include <sstream>

#include <CLI/CLI.hpp>

namespace elastocal::cli {
namespace {

/// The text between `begin` and the next `end`; empty without them.
std::string Between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return "";
  const std::size_t first = from + begin.size();
  const std::size_t last = text.find(end, first);
  return last == std::string::npos ? "" : text.substr(first, last - first);
}

std::vector<std::string> SplitAtCommas(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

/// Reads the type and the checks of an option, which CLI11 gives as one text:
/// "TEXT:{origin,encoder}", "INT:from 2 to 100".
void ReadType(const std::string& type, OptionWords& words) {
  const std::string name = type.substr(0, type.find(':'));
  words.choices = SplitAtCommas(Between(type, "{", "}"));
  const std::string from = ":from ";
  if (const std::size_t at = type.find(from); at != std::string::npos) {
    words.range = type.substr(at + from.size());
  }
  const bool is_number = name == "INT" || name == "UINT" || name == "FLOAT";
  words.value = is_number ? "N" : name == "TEXT" ? "VALUE" : name;
  words.kind = !words.choices.empty()     ? ValueKind::kChoice
               : is_number || name == "N" ? ValueKind::kNumber
               : name == "FILE"           ? ValueKind::kFile
               : name == "DIR"            ? ValueKind::kFolder
                                          : ValueKind::kOther;
}

OptionWords ReadOption(const CLI::Option& option) {
  OptionWords words;
  for (const std::string& name : option.get_snames()) words.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) words.names.push_back("--" + name);
  words.help = option.get_description();
  words.group = option.get_group();
  words.is_required = option.get_required();
  if (option.get_items_expected_max() == 0) return words;
  ReadType(option.get_type_name(), words);
  words.standard = option.get_default_str();
  words.is_repeated = option.get_items_expected_max() > 1;
  if (words.names.empty()) words.value = option.get_single_name();
  return words;
}

CommandWords ReadCommand(const CLI::App& app) {
  CommandWords command{app.get_name(), app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option : app.get_options({})) {
    if (option->get_group().empty()) continue;
    const bool is_argument = option->get_lnames().empty() && option->get_snames().empty();
    (is_argument ? command.arguments : command.options).push_back(ReadOption(*option));
  }
  return command;
}

bool IsIn(const OptionWords& option, const CommandWords& command) {
  return std::any_of(command.options.begin(), command.options.end(), [&](const OptionWords& other) {
    return other.names == option.names && other.help == option.help;
  });
}

}  // namespace

ProgramWords ReadWords(const CLI::App& app) {
  ProgramWords program;
  program.name = app.get_name();
  program.help = app.get_description();
  program.options = ReadCommand(app).options;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (!command->get_group().empty()) program.commands.push_back(ReadCommand(*command));
  }
  if (program.commands.empty()) return program;
  for (const OptionWords& option : program.commands.front().options) {
    const bool is_shared =
        std::all_of(program.commands.begin(), program.commands.end(),
                    [&](const CommandWords& command) { return IsIn(option, command); });
    if (is_shared) program.shared.push_back(option);
  }
  return program;
}

}  // namespace elastocal::cli
