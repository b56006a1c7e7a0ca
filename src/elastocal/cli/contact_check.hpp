// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/cli/command_result.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/pipeline/contact_check.hpp"

namespace elastocal::cli {

/// Options of `check`.
struct CheckCommand {
  CommonOptions common;
  std::string project, calibration;
  std::string output;  ///< path of the posture file; empty: none
  /// One recording; several files if these are tables of observations and of corners.
  std::vector<std::string> recording;
  CheckOptions check;
};

/// Runs `check` for a project with contact or instruments.
CommandResult CheckByContacts(const CheckCommand& command, const Project& project);

}  // namespace elastocal::cli
