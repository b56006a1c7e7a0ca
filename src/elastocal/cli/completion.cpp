// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/completion.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace elastocal::cli {
namespace {

std::string InOneLine(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::vector<std::string> NamesOf(const std::vector<OptionWords>& options) {
  std::vector<std::string> names;
  for (const OptionWords& option : options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

std::vector<std::string> CommandNames(const ProgramWords& program) {
  std::vector<std::string> names;
  for (const CommandWords& command : program.commands) names.push_back(command.name);
  return names;
}

/// The branches of a bash `case` on command:option that complete the value of an option.
std::string BashValues(const CommandWords& command) {
  std::string text;
  for (const OptionWords& option : command.options) {
    if (option.kind == ValueKind::kNone) continue;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names) patterns.push_back(command.name + ":" + name);
    const std::string action = option.kind == ValueKind::kChoice
                                   ? "words='" + InOneLine(option.choices) + "'"
                               : option.kind == ValueKind::kNumber ? "return"
                               : option.kind == ValueKind::kFolder ? "files=-d"
                                                                   : "files=-f";
    text += fmt::format("    {}) {} ;;\n", fmt::join(patterns, "|"), action);
  }
  return text;
}

/// A text for use within the brackets of a zsh specification, in single quotes.
std::string ZshText(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\'') {
      escaped += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string ZshAction(const OptionWords& option) {
  switch (option.kind) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kChoice:
      return "(" + InOneLine(option.choices) + ")";
    case ValueKind::kNumber:
      return " ";
    case ValueKind::kFolder:
      return "_files -/";
    default:
      return "_files";
  }
}

/// Specifications of options for `_arguments`, one line for each name.
std::string ZshOptions(const std::vector<OptionWords>& options, const std::string& indent) {
  std::string text;
  for (const OptionWords& option : options) {
    const std::string others = option.is_repeated ? "*" : "(" + InOneLine(option.names) + ")";
    for (const std::string& name : option.names) {
      const std::string value = option.kind == ValueKind::kNone
                                    ? ""
                                    : ":" + ZshText(option.value) + ":" + ZshAction(option);
      text += fmt::format("{}'{}{}[{}]{}' \\\n", indent, others, name, ZshText(option.help), value);
    }
  }
  return text;
}

}  // namespace

std::string BashCompletion(const ProgramWords& program) {
  std::string values, options;
  for (const CommandWords& command : program.commands) {
    values += BashValues(command);
    options +=
        fmt::format("    {}) words='{}' ;;\n", command.name, InOneLine(NamesOf(command.options)));
  }
  return fmt::format(R"(# Completion of {0} for bash, written by {0} --generate bash.
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command='' words='' files='' i
  # bash takes --option=value for three words.
  if [[ $current == '=' ]]; then
    current=''
  elif [[ $before == '=' ]]; then
    before=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${{COMP_WORDS[i]}} in
      {1}) command=${{COMP_WORDS[i]}}; break ;;
    esac
  done
  case $command:$before in
{2}  esac
  if [[ -z $words$files && -n $command && $current != -* ]]; then files=-f; fi
  if [[ -n $files ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen "$files" -- "$current")
    return
  fi
  [[ -n $words ]] || case $command in
    '') words='{3} {4}' ;;
{5}  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -F _{0} {0}
)",
                     program.name, fmt::join(CommandNames(program), "|"), values,
                     InOneLine(CommandNames(program)), InOneLine(NamesOf(program.options)),
                     options);
}

std::string ZshCompletion(const ProgramWords& program) {
  std::string commands, branches;
  for (const CommandWords& command : program.commands) {
    commands += fmt::format("    '{}:{}'\n", command.name, ZshText(command.help));
    branches += fmt::format(
        "        {})\n          _arguments \\\n{}            '*:file:_files'\n"
        "          ;;\n",
        command.name, ZshOptions(command.options, "            "));
  }
  return fmt::format(R"(#compdef {0}
# Completion of {0} for zsh, written by {0} --generate zsh.
_{0}() {{
  local context state state_descr line
  typeset -A opt_args
  local -a commands=(
{1}  )
  _arguments -C \
{2}    '1:command:->command' \
    '*::argument:->argument'
  case $state in
    command) _describe command commands ;;
    argument)
      case $line[1] in
{3}      esac
      ;;
  esac
}}
_{0} "$@"
)",
                     program.name, commands, ZshOptions(program.options, "    "), branches);
}

}  // namespace elastocal::cli
