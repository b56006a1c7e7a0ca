// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/command_result.hpp"

#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"

namespace elastocal::cli {

void CommandResult::Print(const CommonOptions& options) const {
  cli::Print(options.Silent(), text);
  PrintWarnings(warnings, options.verbose);
  for (const std::string& error : errors) spdlog::error("{}", error);
}

int CommandResult::exit_code() const { return fine ? kFine : kNotConverged; }

}  // namespace elastocal::cli
