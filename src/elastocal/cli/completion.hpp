// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/cli/program_words.hpp"

namespace elastocal::cli {

/// Completion of commands, options, their values and files as a script for bash, which needs no
/// package beside it.
std::string BashCompletion(const ProgramWords& program);

/// The same as the file `_elastocal` for a folder of zsh's fpath.
std::string ZshCompletion(const ProgramWords& program);

}  // namespace elastocal::cli
