// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace elastocal::cli {

/// What is wrong with a command line, in one line: the option, what was found and what was
/// expected.
std::string UsageError(const CLI::App& app, const CLI::Error& error);

/// The same as an error of the program. A second line says where the help is. For
/// CLI::App::failure_message.
std::string UsageMessage(const CLI::App* app, const CLI::Error& error);

}  // namespace elastocal::cli
