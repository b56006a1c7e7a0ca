// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/cli/program_words.hpp"

namespace elastocal::cli {

/// The manual page elastocal(1) as roff source, with the macros of man(7).
std::string ManualPage(const ProgramWords& program);

}  // namespace elastocal::cli
