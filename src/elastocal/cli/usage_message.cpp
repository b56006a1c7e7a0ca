// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/usage_message.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::cli {
namespace {

/// The command on the command line, or the program if there is none.
const CLI::App& GivenCommand(const CLI::App& app) {
  const std::vector<CLI::App*> given = app.get_subcommands();
  return given.empty() ? app : *given.front();
}

/// Text "; did you mean '--lift-mm'?" for an option of the command that begins like this word, or
/// is nearest to it.
std::string NearestOption(const CLI::App& command, const std::string& word) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  for (const std::string& name : known) {
    if (name.starts_with(word)) return "; did you mean '" + name + "'?";
  }
  return DidYouMean(word, known);
}

/// The unknown words, in quotes, because an empty word would be invisible.
std::string UnknownWords(const CLI::App& app) {
  std::string words, nearest;
  for (const std::string& word : app.remaining(true)) {
    words += (words.empty() ? "" : ", ") + Quote(word);
    const bool is_option = word.starts_with("--") && word.size() > 2;
    if (nearest.empty() && is_option) nearest = NearestOption(GivenCommand(app), word);
  }
  return "The following arguments were not expected: " + words + nearest;
}

/// The option in a message "OPTION: rest" of the library.
std::string NameIn(const std::string& message) { return message.substr(0, message.find(": ")); }

std::string WrongCount(const std::string& message) {
  const bool too_many = message.find("At Most") != std::string::npos;
  return NameIn(message) +
         (too_many ? ": found several values; expected one" : ": found nothing; expected a value");
}

template <typename Kind>
bool Is(const CLI::Error& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

}  // namespace

std::string UsageError(const CLI::App& app, const CLI::Error& error) {
  const std::string message = error.what();
  if (Is<CLI::ExtrasError>(error)) return UnknownWords(app);
  if (Is<CLI::RequiredError>(error)) {
    const std::vector<std::string> words = app.remaining(true);
    const bool misspelt = std::ranges::any_of(
        words, [](const std::string& word) { return word.starts_with("--") && word.size() > 2; });
    if (misspelt) return message + ". " + UnknownWords(app);
  }
  if (Is<CLI::ArgumentMismatch>(error)) return WrongCount(message);
  if (Is<CLI::ExcludesError>(error)) {
    const std::string between = " excludes ";
    const std::size_t at = message.find(between);
    return fmt::format("{} and {} cannot be given together", message.substr(0, at),
                       message.substr(at + between.size()));
  }
  return message == "A subcommand is required" ? "A command is required" : message;
}

std::string UsageMessage(const CLI::App* app, const CLI::Error& error) {
  const CLI::App& command = GivenCommand(*app);
  return "elastocal: error: " + UsageError(*app, error) + "\n" +
         fmt::format("elastocal {}--help explains {}.\n",
                     &command == app ? "" : command.get_name() + " ",
                     &command == app ? "what there is" : "the options");
}

}  // namespace elastocal::cli
