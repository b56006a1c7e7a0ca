// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/warning_groups.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <sstream>

#include <fmt/format.h>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

constexpr std::size_t kMostLikewise = 6;

/// A word without surrounding punctuation.
std::string Core(const std::string& word) {
  constexpr const char* kPunctuation = ":,;.()?'";
  const std::size_t begin = word.find_first_not_of(kPunctuation);
  if (begin == std::string::npos) return "";
  return word.substr(begin, word.find_last_not_of(kPunctuation) - begin + 1);
}

bool NamesAnother(const std::string& before) {
  constexpr std::array kKinds = {"trial", "marker", "cluster", "chain", "joint"};
  return std::find(kKinds.begin(), kKinds.end(), before) != kKinds.end();
}

bool IsNumber(const std::string& core) {
  return core.find_first_not_of("0123456789.+-e") == std::string::npos;
}

/// A warning, divided into its statement and its subjects.
struct Parsed {
  std::string pattern;             ///< with "*" for what may differ; a list is one "*"
  std::vector<std::string> names;  ///< the words at these places, without numbers
};

/// Whether a text ends like the name of a file, possibly followed by line numbers ("left.csv",
/// "A-B.csv:45").
bool EndsAsFile(std::string text) {
  constexpr std::array kEndings = {".csv", ".tsv",  ".trc", ".c3d", ".npz", ".yaml", ".yml",
                                   ".txt", ".json", ".bag", ".db3", ".xml", ".urdf", ".mcap"};
  const std::size_t line = text.find_last_not_of("0123456789:");
  if (line != std::string::npos && line + 1 < text.size() && text[line + 1] == ':') {
    text.resize(line + 1);
  }
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const char* ending) { return text.ends_with(ending); });
}

/// Length of the place with which a warning begins ("my table.csv:45", "day 2/left.csv"), up to a
/// colon and a blank. 0 without one.
std::size_t LengthOfPlace(const std::string& warning) {
  const std::size_t colon = warning.find(": ");
  return colon != std::string::npos && EndsAsFile(warning.substr(0, colon)) ? colon : 0;
}

/// Number of words before the end of a file's name that belong to the name, which may contain
/// blanks: those after a preposition ("of day 2/arm A-B.csv:45"). 0 without one.
std::size_t WordsOfName(const std::vector<std::string>& before) {
  constexpr std::array kPrepositions = {"in", "of", "at", "from", "by", "and", "to", "with"};
  for (std::size_t count = 0; count < before.size(); ++count) {
    const std::string& word = before[before.size() - 1 - count];
    const bool ends =
        word.ends_with(',') || word.ends_with(':') || word.ends_with(';') ||
        std::find(kPrepositions.begin(), kPrepositions.end(), word) != kPrepositions.end();
    if (ends) return count;
  }
  return 0;
}

/// The words of a sentence; a name is one word, even if it contains blanks.
std::vector<std::string> WordsOf(const std::string& sentence) {
  std::vector<std::string> words;
  std::istringstream stream(sentence);
  for (std::string word; stream >> word;) {
    if (EndsAsFile(Core(word))) {
      for (std::size_t count = WordsOfName(words); count > 0; --count) {
        word.insert(0, words.back() + " ");
        words.pop_back();
      }
    }
    words.push_back(word);
  }
  return words;
}

Parsed Parse(const std::string& warning) {
  Parsed parsed;
  std::vector<std::string> pattern;
  const std::size_t place = LengthOfPlace(warning);
  if (place > 0) {
    parsed.names.push_back(warning.substr(0, place));
    pattern.emplace_back("*:");
  }
  std::string before;
  for (std::string word : WordsOf(warning.substr(place > 0 ? place + 1 : 0))) {
    const std::string core = Core(word);
    const bool varies =
        core.find_first_of("0123456789_.-") != std::string::npos || NamesAnother(before);
    before = core;
    if (!varies) {
      pattern.push_back(word);
      continue;
    }
    if (!IsNumber(core)) parsed.names.push_back(core);
    word.replace(word.find(core), core.size(), "*");
    // "*, *", and "* and * more" of a longer list, count as "*".
    if (!pattern.empty() && pattern.back() == "*,") pattern.pop_back();
    pattern.push_back(word);
  }
  parsed.pattern = fmt::format("{}", fmt::join(pattern, " "));
  for (std::size_t at = 0; (at = parsed.pattern.find("* and * more")) != std::string::npos;) {
    parsed.pattern.replace(at, 12, "*");
  }
  return parsed;
}

/// Warnings with the same pattern.
struct Group {
  std::string pattern, first;
  std::vector<std::string> known;   ///< names in the first warning
  std::vector<std::string> others;  ///< new names in each further warning
  int count = 0;
};

void Add(const Parsed& parsed, Group& group) {
  ++group.count;
  std::string other;
  for (const std::string& name : parsed.names) {
    if (std::find(group.known.begin(), group.known.end(), name) != group.known.end()) continue;
    other += (other.empty() ? "" : " ") + name;
  }
  const bool is_new =
      std::find(group.others.begin(), group.others.end(), other) == group.others.end();
  if (!other.empty() && is_new) group.others.push_back(other);
}

std::string Sentence(const Group& group) {
  if (group.count == 1) return group.first;
  if (group.others.empty()) return fmt::format("{} ({} times)", group.first, group.count);
  return fmt::format("{} (likewise {})", group.first, FirstOf(group.others, kMostLikewise));
}

}  // namespace

std::vector<std::string> GroupWarnings(const std::vector<std::string>& warnings) {
  std::vector<Group> groups;
  for (const std::string& warning : warnings) {
    const Parsed parsed = Parse(warning);
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& known) { return known.pattern == parsed.pattern; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), {parsed.pattern, warning, parsed.names, {}, 0});
    }
    Add(parsed, *group);
  }
  std::vector<std::string> sentences;
  for (const Group& group : groups) sentences.push_back(Sentence(group));
  return sentences;
}

}  // namespace elastocal::cli
