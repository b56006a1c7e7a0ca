// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/cli/program_words.hpp"

namespace elastocal::cli {

/// Script for bash that completes commands, options, their values and files. It needs no other
/// package.
std::string BashCompletion(const ProgramWords& program);

/// The same for zsh: contents of the file `_elastocal` in a folder of fpath.
std::string ZshCompletion(const ProgramWords& program);

}  // namespace elastocal::cli
