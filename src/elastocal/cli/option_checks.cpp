#include "elastocal/cli/option_checks.hpp"

#include "elastocal/tables/text.hpp"

namespace elastocal::cli {

std::string IsShare(const std::string& text) {
  const auto number = ParseNumber(text);
  if (number && *number > 0.0 && *number <= 1.0) return "";
  return "found " + Quote(text) + "; a share above 0 and up to 1 was expected";
}

}  // namespace elastocal::cli
