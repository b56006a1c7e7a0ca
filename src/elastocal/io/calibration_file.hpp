// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/io/held_root.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// 3-D RMSE of markers that an estimate did not use (held-out trials or postures), m; 0: not known.
struct HeldOutErrors {
  double urdf = 0.0;         ///< by the calibrated URDF alone
  double compensated = 0.0;  ///< by the calibrated model, with elasticity
};

/// What a calibration.yaml holds in addition to its result.
struct BesideCalibration {
  /// The result that has only waist and markers fitted to the same recording, for a comparison on
  /// other recordings.
  const CalibrationResult* uncalibrated = nullptr;
  /// The result whose geometry the calibrated URDF has, if that is another one: a rigid model that
  /// predicts better than the geometry of the elastic model alone. Null: the same result.
  const CalibrationResult* in_urdf = nullptr;
  Eigen::Vector3d gravity = kGravity;  ///< in the frame of the recording, m/s^2
  /// 3-D RMSE of the result on its own markers, outliers included, m; 0: not known.
  double rmse_3d = 0.0;
  HeldOutErrors held_out = {};
  std::vector<SoleSpring> soles = {};
};

/// calibration.yaml: every parameter with unit, value, standard deviation and status, and what is
/// needed to judge them (docs/formats.md).
std::string MakeCalibrationYaml(const CalibrationResult& result, const std::string& recording,
                                ZeroOffsets zero_offsets, const BesideCalibration& beside = {});

/// The same file for a robot without a recording of its own, such as a fleet's prior.
std::string MakeCalibrationYaml(const CalibrationEstimate& estimate);

/// Reads all of a calibration.yaml that a comparison needs; the covariance is in another file.
/// Throws InputError naming file, line and key, also for a file that was cut, a unit that its
/// parameter cannot have, and an angle beyond half a turn.
CalibrationEstimate ReadEstimate(const std::filesystem::path& file);

/// The same from the text of a file; `source` names it in messages.
CalibrationEstimate ParseEstimate(const std::string& text, const std::string& source);

/// The contents of a calibration.yaml that another run needs.
struct StoredCalibration {
  std::string source;       ///< the file, for messages
  std::string fingerprint;  ///< CalibrationFingerprint of its text
  std::string robot;
  std::string nominal;  ///< NominalFingerprint of the robot to which the errors refer
  std::string recording;
  double rmse_3d = 0.0;    ///< 3-D RMSE on its own markers, m; 0: the file does not say
  HeldOutErrors held_out;  ///< errors on markers that it did not use
  /// Standard deviation of a marker coordinate that independent postures would have, if they told
  /// as much as these postures do, m; 0: the file does not say.
  double scatter_sd = 0.0;
  std::map<std::string, double> joint_errors;  ///< by parameter name, SI
  /// The errors that the calibrated URDF has, if they are others; else empty.
  std::map<std::string, double> urdf_errors;
  std::vector<SoleSpring> soles;  ///< springs of the feet whose springs the loads tell
  /// Posture table: nominal pose of the waist in the frame of the recording.
  std::optional<Transform> T_ref_waist;
  Eigen::Vector3d gravity = kGravity;  ///< in that frame, m/s^2
  std::optional<HeldRoot> held_root;   ///< trials: the attitude in which the root link was held
  /// Waist (deviations from `T_ref_waist`) and markers, by parameter name, SI: of the calibrated
  /// model, and of the uncalibrated one fitted to the same recording (empty if the file does not
  /// have it).
  std::map<std::string, double> externals, uncalibrated_externals;
  std::map<std::string, int> lines;  ///< line of each parameter in the file, by parameter name
};

/// Reads a calibration.yaml. Throws InputError naming file, line and key.
StoredCalibration ReadCalibration(const std::filesystem::path& file);

/// The calibration as the calibrated URDF has it: if the file has errors for the URDF
/// (StoredCalibration::urdf_errors), these replace the joint errors, and parameters that they lack
/// (compliances among them) become zero. Otherwise the calibration is unchanged.
StoredCalibration AsInUrdf(StoredCalibration stored);

/// Throws InputError, naming the line, for a parameter of a joint or chain that neither the model
/// nor `chains` has, and for a joint that lacks some of its geometric parameters. The model must
/// have all markers of the project.
void CheckParameters(const StoredCalibration& stored, const ErrorModel& model,
                     const std::vector<std::string>& chains);

}  // namespace elastocal
