// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "elastocal/math/utf8.hpp"

namespace elastocal {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

std::string Quote(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string_view begin = text.substr(0, kLongest);
  // The text is not clipped in the middle of a character.
  const auto continues = [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;
  };
  while (begin.size() < text.size() && !begin.empty() && continues(text[begin.size()])) {
    begin.remove_suffix(1);
  }
  std::string shown = Printable(begin);
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c == '\n' || c == '\t'; }, '?');
  return "'" + shown + (text.size() > kLongest ? "..." : "") + "'";
}

std::string Place(const std::string& source, int line) {
  return source + ":" + std::to_string(line) + ": ";
}

std::string_view Trim(std::string_view text) {
  while (!text.empty() && IsSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsSpace(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> ParseNumber(std::string_view text) {
  text = Trim(text);
  // std::from_chars takes no plus sign.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

bool IsGap(std::string_view cell) {
  std::string lower(Trim(cell).substr(0, 5));
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower.empty() || lower == "nan" || lower == "null";
}

std::string FormatNumber(double value) {
  std::string text;
  AppendNumber(value, text);
  return text;
}

void AppendNumber(double value, std::string& text) {
  std::array<char, 32> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), end);
}

void AppendFixed(double value, int decimals, std::string& text) {
  // The largest double has 309 digits before the point.
  std::array<char, 340> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                          std::chars_format::fixed, decimals);
  text.append(buffer.data(), end);
}

}  // namespace elastocal
