// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/manual_page.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

namespace elastocal::cli {
namespace {

/// Escapes a text for roff: escapes, requests at the beginning of a line, and hyphens, which must
/// be copyable.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const bool begins_line = escaped.empty() || escaped.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Bold(const std::string& text) { return "\\fB" + Escaped(text) + "\\fR"; }
std::string Italic(const std::string& text) { return "\\fI" + Escaped(text) + "\\fR"; }

std::string RoffSentence(const std::string& text) {
  const bool ends = text.empty() || text.back() == '.' || text.back() == ':';
  return Escaped(text) + (ends ? "" : ".");
}

/// A tagged paragraph with an option and its description.
std::string OptionParagraph(const OptionWords& option) {
  std::string tag;
  for (const std::string& name : option.names) tag += (tag.empty() ? "" : ", ") + Bold(name);
  const std::string dots = option.is_repeated ? "..." : "";
  if (!option.value.empty()) tag += (tag.empty() ? "" : " ") + Italic(option.value) + dots;
  std::string text = ".TP\n" + tag + "\n" + RoffSentence(option.help) + "\n";
  if (!option.choices.empty()) {
    text += Escaped(fmt::format("One of: {}.", fmt::join(option.choices, ", "))) + "\n";
  }
  if (!option.range.empty()) text += Escaped("From " + option.range + ".") + "\n";
  if (!option.standard.empty()) text += Escaped("Default: " + option.standard + ".") + "\n";
  if (option.is_required && !option.names.empty()) text += "Required.\n";
  return text;
}

/// The lines below a command's help: sentences, and its example as typed.
std::string FooterParagraphs(const std::string& footer) {
  const std::string mark = "Example: ";
  std::string text;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(mark)) {
      text += (text.empty() ? ".PP\n" : "") + Escaped(line) + "\n";
      continue;
    }
    text += ".PP\nExample:\n.RS 4\n" + Bold(line.substr(mark.size())) + "\n.RE\n";
  }
  return text;
}

std::string Synopsis(const ProgramWords& program, const CommandWords& command) {
  std::string text = Bold(program.name + " " + command.name);
  for (const OptionWords& argument : command.arguments) text += " " + Italic(argument.value);
  for (const OptionWords& option : command.options) {
    if (option.is_required) text += " " + Bold(option.names.back()) + " " + Italic(option.value);
  }
  return text + " [" + Italic("option") + "...]";
}

bool IsShared(const ProgramWords& program, const OptionWords& option) {
  return std::any_of(program.shared.begin(), program.shared.end(),
                     [&](const OptionWords& shared) { return shared.names == option.names; });
}

std::string CommandSection(const ProgramWords& program, const CommandWords& command) {
  std::string text = ".SS " + command.name + "\n" + Synopsis(program, command) + "\n.PP\n" +
                     RoffSentence(command.help) + "\n";
  for (const OptionWords& argument : command.arguments) text += OptionParagraph(argument);
  std::string group = "Options";
  for (const OptionWords& option : command.options) {
    if (IsShared(program, option)) continue;
    if (option.group != group) text += ".PP\n" + Escaped(option.group) + ":\n";
    group = option.group;
    text += OptionParagraph(option);
  }
  return text + FooterParagraphs(command.footer);
}

}  // namespace

std::string ManualPage(const ProgramWords& program) {
  std::string help = program.help;
  if (!help.empty() && help.back() == '.') help.pop_back();
  std::string text = fmt::format(
      ".\\\" Written by {0} \\-\\-generate man.\n"
      ".TH ELASTOCAL 1 \"\" \"{0} {1}\" \"User Commands\"\n"
      ".nh\n.ad l\n"
      ".SH NAME\n{0} \\- {2}\n.SH SYNOPSIS\n",
      program.name, Escaped(program.version), Escaped(help));
  for (const CommandWords& command : program.commands) {
    text += Synopsis(program, command) + "\n.br\n";
  }
  text += Bold(program.name + " " + "--help") + " | " + Bold("--version") + "\n";
  text += ".SH DESCRIPTION\n" + RoffSentence(program.help) + "\nThe commands:\n";
  for (const CommandWords& command : program.commands) {
    text += ".TP\n" + Bold(command.name) + "\n" + RoffSentence(command.help) + "\n";
  }
  text += ".SH OPTIONS\nWithout a command:\n";
  for (const OptionWords& option : program.options) text += OptionParagraph(option);
  text += ".PP\nOf every command:\n";
  for (const OptionWords& option : program.shared) text += OptionParagraph(option);
  text += ".SH COMMANDS\n";
  for (const CommandWords& command : program.commands) text += CommandSection(program, command);
  text += ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : program.exit_codes) {
    text += fmt::format(".TP\n.B {}\n{}\n", code, RoffSentence(meaning));
  }
  return text;
}

}  // namespace elastocal::cli
