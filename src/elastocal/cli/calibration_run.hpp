// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// Options of `calibrate`.
struct CalibrateOptions {
  CommonOptions common;
  std::string project, output;
  std::vector<std::string> recordings;  ///< a posture table, or recording folders
  std::optional<int> folds;             ///< empty: the usual number, see ExperimentOptions
  std::string fold_by = "posture";
  int threads = 2;
  std::string zero_offsets = "origin";
  std::string prior;                ///< path of an earlier calibration; empty: none
  double days = 1.0;                ///< age of the earlier calibration
  std::string marker_places;        ///< table of measured marker positions; empty: none
  std::vector<std::string> accept;  ///< mistakes of the recording that are corrected
};

/// Calibrates, prints the tables and writes the output folder. Nothing is written before everything
/// has been computed. `run`, if not null, receives the run. Returns the exit code.
int RunCalibration(const CalibrateOptions& options, CalibrationRun* run = nullptr);

}  // namespace elastocal::cli
