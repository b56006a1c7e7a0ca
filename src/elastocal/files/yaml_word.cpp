// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/yaml_word.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace elastocal {

std::string YamlWord(const std::string& text) {
  constexpr std::array kReserved = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"};
  std::string lower;
  bool plain = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    plain = plain && u < 128 && (std::isalnum(u) != 0 || c == '_' || c == '-' || c == '.');
    lower += static_cast<char>(std::tolower(u));
  }
  plain = plain && std::ranges::find(kReserved, lower) == kReserved.end();
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return quoted + "\"";
}

}  // namespace elastocal
