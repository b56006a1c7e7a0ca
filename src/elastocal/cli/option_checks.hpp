// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace elastocal::cli {

// What CLI::Option::check and ::transform take. Their messages say what was found and what was
// expected; the library puts the option's name in front.

/// A number within the bounds of an option, "COMMAND --option" (bounds.hpp).
std::function<std::string(const std::string&)> InBounds(const std::string& key);

/// A whole number, or any number, from `least` to `most`.
CLI::Validator FromTo(int least, int most);
CLI::Validator FromTo(double least, double most);

/// One of the names, in small letters or capitals; becomes the name as it stands in the list.
CLI::Validator OneOf(const std::vector<std::string>& names);

/// A whole number of at least 0, which 64 bits can hold.
std::string IsSeed(const std::string& text);

/// The name of an output: not empty.
std::string IsNamed(const std::string& text);

}  // namespace elastocal::cli
