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

/// Name of the calibrated URDF in the folder of a calibration.
std::string CalibratedUrdfName(const std::filesystem::path& urdf);

/// Names of the files that a calibration writes into its folder (docs/formats.md). To be deployed
/// are ROBOT_calibrated.urdf, calibration.yaml, offsets.xacro and covariance.csv; summary.json and
/// report_data.json tell how the calibration went.
std::vector<std::string> CalibrationFileNames(const Project& project);

/// Contents of these files by name. The first four exist only where the run is deployable. Adds to
/// `run.warnings` what the report cannot show.
std::map<std::string, std::string> MakeCalibrationFiles(const Project& project,
                                                        CalibrationRun& run);

/// Where a calibration is stored.
struct CalibrationFiles {
  std::filesystem::path calibration;  ///< path of calibration.yaml
  std::filesystem::path covariance;   ///< path of covariance.csv beside it, which need not exist
};

/// Finds the files of a calibration, given as the folder that calibrate wrote to or as its
/// calibration.yaml. First repairs what a killed run left in the folder. Throws InputError for a
/// folder without calibration.yaml, and for a folder with files of two runs (CheckChecksums).
CalibrationFiles FindCalibrationFiles(const std::filesystem::path& given);

/// Reads both files. Throws InputError that names file and line.
CalibrationEstimate ReadCalibrationFiles(const CalibrationFiles& files);

}  // namespace elastocal
