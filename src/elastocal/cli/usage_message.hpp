// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace elastocal::cli {

/// Describes an error in a command line in one line: the option, what was found and what was
/// expected.
std::string UsageError(const CLI::App& app, const CLI::Error& error);

/// UsageError as an error message of the program, with a second line that says where the help is.
/// For CLI::App::failure_message.
std::string UsageMessage(const CLI::App* app, const CLI::Error& error);

}  // namespace elastocal::cli
