// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace elastocal::cli {

// Arguments for CLI::Option::check and ::transform. Their messages say what was found and what was
// expected; the library puts the option's name in front.

/// Accepts a number within the bounds of an option, "COMMAND --option" (bounds.hpp).
std::function<std::string(const std::string&)> InBounds(const std::string& key);

/// Accepts a whole number, or any number, from `least` to `most`.
CLI::Validator FromTo(int least, int most);
CLI::Validator FromTo(double least, double most);

/// Accepts one of the names in any case, and converts it to the form in the list.
CLI::Validator OneOf(const std::vector<std::string>& names);

/// Accepts a whole number from 0 that 64 bits can hold.
std::string IsSeed(const std::string& text);

/// Accepts a name of an output that is not empty.
std::string IsNamed(const std::string& text);

}  // namespace elastocal::cli
