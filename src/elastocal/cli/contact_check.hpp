// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/pipeline/contact_check.hpp"

namespace elastocal::cli {

struct ContactCheckCommand {
  CommonOptions common;
  std::string calibration;
  std::string output;                  ///< posture file; empty: none
  std::vector<std::string> recording;  ///< tables of observations and of corners
  CheckOptions check;
};

/// `check` for a project with contact or instruments.
int RunContactCheck(const ContactCheckCommand& command, const Project& project);

}  // namespace elastocal::cli
