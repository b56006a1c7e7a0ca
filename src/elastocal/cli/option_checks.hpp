// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace elastocal::cli {

// For CLI::Option::check: what is wrong with the text; empty where nothing is.

/// A number within the bounds of an option, "COMMAND --option" (bounds.hpp). Of what CLI11 offers,
/// Range takes NaN.
std::function<std::string(const std::string&)> InBounds(const std::string& key);

/// The name of an output: not empty.
std::string IsNamed(const std::string& text);

}  // namespace elastocal::cli
