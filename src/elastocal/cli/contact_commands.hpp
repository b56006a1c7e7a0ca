// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/cli/command_result.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal::cli {

/// Runs `calibrate` for a project with contact or instruments, whose recordings are tables of
/// observations.
CommandResult CalibrateByContacts(const CalibrateOptions& options, const Project& project,
                                  const std::vector<std::filesystem::path>& recordings);

/// Runs `validate` for such a project. `accept` names mistakes that are corrected first.
CommandResult ValidateByContacts(const Project& project, const std::filesystem::path& calibration,
                                 const std::vector<std::filesystem::path>& recordings,
                                 bool refit_table, const std::vector<std::string>& accept);

}  // namespace elastocal::cli
