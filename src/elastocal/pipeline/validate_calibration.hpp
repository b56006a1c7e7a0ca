// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {

/// Result of ValidateCalibration: a calibration on a recording from which it was not made.
struct ValidationRun {
  StoredCalibration calibration;
  std::string calibration_file;  ///< path of its calibration.yaml
  Recording recording;
  TransferValidation transfer;
  std::optional<Refit> urdf;  ///< fit with the geometry of the calibrated URDF; empty if frozen
  /// Expected error of a robot that was never calibrated (ExpectedError), m.
  double expected_error = 0.0;
  bool frozen = false;  ///< nothing was fitted
  /// Mistakes of the recording, or contradictions to the calibration; with any of them the errors
  /// judge nothing.
  std::vector<std::string> mistakes;
  std::vector<std::string> not_judged;  ///< trials that cannot be used, a sentence each
  std::vector<std::string> warnings;    ///< what the user should know, a sentence each
  /// Error that the calibration expects on other recordings, and the error on this one, m: by the
  /// calibrated URDF, or by the calibrated model if frozen. `predicted` is 0 where the calibration
  /// held out no data.
  double predicted = 0.0, shown = 0.0;
  /// Residuals of marker positions that were measured on their links.
  std::vector<PlaceResidual> places = {};
  bool own_recording = false;  ///< the calibration was made from this recording

  bool converged() const;
  /// Whether the calibrated robot has a smaller error than the uncalibrated one, outliers included.
  bool better() const;
  /// Whether the URDF alone, which many users deploy, errs by more than 5 % more than the
  /// uncalibrated robot, outliers included; false if frozen.
  bool urdf_worse() const;
  /// Whether the error of the calibrated robot is less than twice that expected of a robot that was
  /// never calibrated. Otherwise recording, project and calibration do not belong together.
  bool plausible() const;
  /// Whether the error of the calibrated robot is at most kWorseThanPredicted times the predicted
  /// one; true where none was predicted.
  bool as_predicted() const;
};

/// Allowed ratio of the shown to the predicted error. Other days and other parts of the workspace
/// give somewhat larger errors than held-out postures.
inline constexpr double kWorseThanPredicted = 1.5;

/// Settings of ValidateCalibration.
struct TransferOptions {
  /// Fits nothing: waist and markers are those of the calibration (see ValidateFrozen).
  bool frozen = false;
  std::optional<std::uint64_t> seed = {};  ///< default: the project's
  /// Mistakes of the recording that are corrected first, see AcceptMistakes.
  std::vector<std::string> accept = {};
  /// File of marker positions measured on their links (ReadMarkerPlaces); empty: none. Both robots
  /// are fitted with these positions as prior knowledge, with their stated standard deviations.
  std::filesystem::path marker_places = {};
};

/// Applies a stored calibration to another recording of the same robot. Only waist and markers are
/// fitted, for the calibrated and for the nominal robot (paper, section 6.1.4), or nothing.
/// Mistakes of a recording that explain its misfit are named (FindMistakesBy), and so are faults by
/// which it contradicts the calibration (FindTransferFaults).
///
/// `calibration` is the folder that calibrate wrote to, or its calibration.yaml. `recording` is a
/// posture table or a recording folder. Its trials for validation are judged where none is for
/// calibration; else a warning names them. Throws InputError for files that cannot be read, for a
/// calibration of a robot with other nominal geometry than the project's, and for positions of
/// markers where nothing is fitted.
ValidationRun ValidateCalibration(const Project& given, const std::filesystem::path& calibration,
                                  const std::filesystem::path& recording,
                                  const TransferOptions& options = {});

/// "better", "not better", "implausible" or "not converged".
std::string ValidationStatus(const ValidationRun& run);

/// validation.json: the figures for programs (docs/formats.md).
std::string MakeValidationJson(const ValidationRun& run);

}  // namespace elastocal
