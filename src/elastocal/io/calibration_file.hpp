#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/io/calibrated_urdf.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// Tells nominal robots apart: the errors of a calibration are deviations from one of them and mean
/// nothing on another. 16 hexadecimal digits (FNV-1a, 64 bit) over every joint's name, type,
/// parent, mimicking and placement (radians and metres, rounded to 1e-9). Links, limits, inertia,
/// visuals, comments and markers do not count.
std::string NominalFingerprint(const ErrorModel& model);

/// calibration.yaml: every parameter with unit, value, standard deviation and status, and what is
/// needed to judge them (docs/formats.md).
/// `uncalibrated`, where given: the result that has only waist and markers fitted to the same
/// recording, for a comparison on other recordings.
std::string MakeCalibrationYaml(const CalibrationResult& result, const std::string& recording,
                                ZeroOffsets zero_offsets,
                                const CalibrationResult* uncalibrated = nullptr);

/// Reads all of a calibration.yaml that a comparison needs; the covariance is in another file.
/// Throws InputError naming file, line and key.
CalibrationEstimate ReadEstimate(const std::filesystem::path& file);

/// The same from the text of a file; `source` names it in messages.
CalibrationEstimate ParseEstimate(const std::string& text, const std::string& source);

/// What another run needs of such a file.
struct StoredCalibration {
  std::string robot;
  std::string nominal;  ///< NominalFingerprint of the robot that the errors are deviations from
  std::string recording;
  std::map<std::string, double> joint_errors;  ///< by parameter name, SI
  /// Of a table of postures: nominal pose of the waist in the frame of the recording.
  std::optional<Transform> T_ref_waist;
  /// Waist (deviations from there) and markers, by parameter name, SI: of the calibrated model, and
  /// of the uncalibrated one fitted to the same recording (empty if the file does not have it).
  std::map<std::string, double> externals, uncalibrated_externals;
};

/// Reads a calibration.yaml. Throws InputError naming file, line and key.
StoredCalibration ReadCalibration(const std::filesystem::path& file);

}  // namespace elastocal
