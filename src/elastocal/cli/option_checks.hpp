#pragma once

#include <string>

namespace elastocal::cli {

/// For CLI::Option::check: what is wrong with the text as a share above 0 and up to 1; empty where
/// nothing is.
std::string IsShare(const std::string& text);

}  // namespace elastocal::cli
