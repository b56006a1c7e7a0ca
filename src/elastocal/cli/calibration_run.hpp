// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

struct CalibrateOptions {
  CommonOptions common;
  std::string project, output;
  std::vector<std::string> recordings;  ///< a posture table, or recording folders
  std::optional<int> folds;             ///< none: as usual, see ExperimentOptions
  std::string fold_by = "posture";
  int threads = 2;
  std::string zero_offsets = "origin";
  std::string prior;                ///< an earlier calibration; empty: none
  double days = 1.0;                ///< since then
  std::string marker_places;        ///< table of measured ones; empty: none
  std::vector<std::string> accept;  ///< mistakes of the recording to correct
};

/// Calibrates, prints the tables and writes the output folder; nothing is written before everything
/// has been computed. The run is returned through `run` where that is not null.
int RunCalibration(const CalibrateOptions& options, CalibrationRun* run = nullptr);

}  // namespace elastocal::cli
