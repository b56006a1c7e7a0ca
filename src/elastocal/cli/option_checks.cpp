#include "elastocal/cli/option_checks.hpp"

#include <cmath>

#include "elastocal/tables/text.hpp"

namespace elastocal::cli {

std::string IsNumber(const std::string& text) {
  const auto number = ParseNumber(text);
  if (number && std::isfinite(*number)) return "";
  return "found " + Quote(text) + "; a number was expected";
}

std::string IsNamed(const std::string& text) {
  return text.empty() ? "the output needs a name" : "";
}

}  // namespace elastocal::cli
