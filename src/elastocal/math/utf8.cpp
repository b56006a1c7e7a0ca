// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/utf8.hpp"

#include <algorithm>

#include <boost/locale/utf.hpp>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// Place of the first character that is not UTF-8; the size of the text if there is none.
std::size_t FindNotUtf8(std::string_view text) {
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at != end;) {
    const char* const begin = at;
    const auto code = boost::locale::utf::utf_traits<char>::decode(at, end);
    if (!boost::locale::utf::is_valid_codepoint(code)) return begin - text.data();
  }
  return text.size();
}

}  // namespace

bool IsUtf8(std::string_view text) { return FindNotUtf8(text) == text.size(); }

std::string Printable(std::string_view text) {
  std::string printable;
  printable.reserve(text.size());
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at != end;) {
    const char* const begin = at;
    const auto code = boost::locale::utf::utf_traits<char>::decode(at, end);
    if (!boost::locale::utf::is_valid_codepoint(code)) {
      printable += "\uFFFD";
      at = begin + 1;
    } else if ((code < 0x20 && code != '\n' && code != '\t') || (code >= 0x7f && code < 0xa0)) {
      printable += '?';
    } else {
      printable.append(begin, at);
    }
  }
  return printable;
}

void RequireUtf8(std::string_view text, const std::string& source, int first_line) {
  const std::size_t place = FindNotUtf8(text);
  if (place == text.size()) return;
  const std::string_view before = text.substr(0, place);
  const auto line = first_line + std::count(before.begin(), before.end(), '\n');
  constexpr std::size_t kLongestShown = 30;
  std::string_view shown = before.substr(before.rfind('\n') + 1);  // npos + 1 is 0
  if (shown.size() > kLongestShown) shown.remove_prefix(shown.size() - kLongestShown);
  while (!IsUtf8(shown)) shown.remove_prefix(1);  // the rest of a character
  throw InputError(source + ":" + std::to_string(line) + ": what follows '" + std::string(shown) +
                   "' is not UTF-8 (Latin-1?); save the file as UTF-8");
}

}  // namespace elastocal
