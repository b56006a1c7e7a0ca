// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/option_checks.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "elastocal/files/bounds.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::cli {
namespace {

std::string FoundInstead(const std::string& text, const std::string& expected) {
  return "found " + Quote(text) + "; expected " + expected;
}

/// The description "from LEAST to MOST" appears in the help, and ReadWords searches for it.
CLI::Validator NumberFromTo(double least, double most, const char* kind, bool whole) {
  const std::string range = fmt::format("from {:.10g} to {:.10g}", least, most);
  const auto check = [=](std::string& text) {
    const std::optional<double> number = ParseNumber(text);
    const bool written_whole = text.find_first_not_of("+-0123456789") == std::string::npos;
    const bool fits = number && *number >= least && *number <= most && (!whole || written_whole);
    return fits ? "" : FoundInstead(text, std::string(kind) + " " + range);
  };
  return {check, range};
}

/// Names as text: "a", "a or b", "a, b or c".
std::string EitherOf(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    list += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  }
  return list;
}

}  // namespace

std::function<std::string(const std::string&)> InBounds(const std::string& key) {
  return [range = BoundsOf(key)](const std::string& text) {
    const auto number = ParseNumber(text);
    return number && range.Contains(*number) ? "" : FoundInstead(text, range.InWords());
  };
}

CLI::Validator FromTo(int least, int most) {
  return NumberFromTo(least, most, "a whole number", true);
}

CLI::Validator FromTo(double least, double most) {
  return NumberFromTo(least, most, "a number", false);
}

CLI::Validator OneOf(const std::vector<std::string>& names) {
  const auto choose = [names](std::string& text) -> std::string {
    for (const std::string& name : names) {
      if (CLI::detail::to_lower(name) != CLI::detail::to_lower(text)) continue;
      text = name;
      return "";
    }
    return FoundInstead(text, EitherOf(names)) + DidYouMean(text, names);
  };
  return {choose, fmt::format("{{{}}}", fmt::join(names, ","))};
}

std::string IsSeed(const std::string& text) {
  std::uint64_t seed = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seed);
  return error == std::errc() && stop == end ? "" : FoundInstead(text, "a whole number from 0 on");
}

std::string IsNamed(const std::string& text) {
  return text.empty() ? "the output needs a name" : "";
}

}  // namespace elastocal::cli
