#pragma once

#include <string>

namespace elastocal::cli {

// For CLI::Option::check: what is wrong with the text; empty where nothing is.

/// A finite number. CLI::Range alone takes NaN.
std::string IsNumber(const std::string& text);

/// The name of an output: not empty.
std::string IsNamed(const std::string& text);

}  // namespace elastocal::cli
