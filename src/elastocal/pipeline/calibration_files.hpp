// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elastocal/pipeline/calibrate_experiment.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// The names of the files that a calibration writes into its folder (docs/formats.md). Those for
/// whoever deploys it: ROBOT_calibrated.urdf, calibration.yaml, offsets.xacro, covariance.csv; and
/// those that tell how it went: summary.json, report_data.json.
std::vector<std::string> CalibrationFileNames(const Project& project);

/// The contents of these files by name. The first four are there only where the run is deployable.
/// Adds to `run.warnings` what the report cannot show.
std::map<std::string, std::string> MakeCalibrationFiles(const Project& project,
                                                        CalibrationRun& run);

/// Where a calibration is stored.
struct CalibrationFiles {
  std::filesystem::path calibration;  ///< calibration.yaml
  std::filesystem::path covariance;   ///< covariance.csv beside it; need not be there
};

/// The files of a calibration, given as the folder that calibrate wrote to (what a killed run left
/// there is put in order first) or as its calibration.yaml. Throws InputError for a folder without
/// calibration.yaml, and for one of two runs (CheckChecksums).
CalibrationFiles FindCalibrationFiles(const std::filesystem::path& given);

/// Reads both. Throws InputError naming file and line.
CalibrationEstimate ReadCalibrationFiles(const CalibrationFiles& files);

}  // namespace elastocal
