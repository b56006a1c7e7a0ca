#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/io/calibrated_urdf.hpp"

namespace elastocal {

/// calibration.yaml: every parameter with unit, value, standard deviation and status, and what is
/// needed to judge them (docs/formats.md).
std::string MakeCalibrationYaml(const CalibrationResult& result, const BaseParameters& base,
                                const std::string& recording, ZeroOffsets zero_offsets);

/// What another run needs of such a file.
struct StoredCalibration {
  std::string robot;
  std::string recording;
  std::map<std::string, double> joint_errors;  ///< by parameter name, rad or m
};

/// Reads a calibration.yaml. Throws InputError naming file, line and key.
StoredCalibration ReadCalibration(const std::filesystem::path& file);

}  // namespace elastocal
