// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/cli/command_result.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/pipeline/contact_check.hpp"

namespace elastocal::cli {

struct CheckCommand {
  CommonOptions common;
  std::string project, calibration;
  std::string output;                  ///< posture file; empty: none
  std::vector<std::string> recording;  ///< one; of tables of observations and of corners several
  CheckOptions check;
};

/// `check` for a project with contact or instruments.
CommandResult CheckByContacts(const CheckCommand& command, const Project& project);

}  // namespace elastocal::cli
