// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal::cli {

/// `calibrate` for a project with contact: prints what touches tell and writes the output folder.
int RunContactCalibration(const CalibrateOptions& options, const Project& project);

struct ContactValidateOptions {
  CommonOptions common;
  std::string calibration;
  std::vector<std::string> recording;  ///< tables of observations and of corners
  std::string output;                  ///< folder; empty: none
  bool refit_table = false;
  std::vector<std::string> accept;  ///< mistakes that are corrected first
};

/// `validate` for such a project.
int RunContactValidation(const ContactValidateOptions& options, const Project& project);

}  // namespace elastocal::cli
