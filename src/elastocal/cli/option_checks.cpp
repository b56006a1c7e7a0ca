// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/option_checks.hpp"

#include "elastocal/files/bounds.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::cli {

std::function<std::string(const std::string&)> InBounds(const std::string& key) {
  return [range = BoundsOf(key)](const std::string& text) {
    const auto number = ParseNumber(text);
    if (number && range.Contains(*number)) return std::string();
    return "found " + Quote(text) + "; expected " + range.InWords();
  };
}

std::string IsNamed(const std::string& text) {
  return text.empty() ? "the output needs a name" : "";
}

}  // namespace elastocal::cli
