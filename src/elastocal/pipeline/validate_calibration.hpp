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

/// A calibration on a recording that it was not made from.
struct ValidationRun {
  StoredCalibration calibration;
  std::string calibration_file;  ///< its calibration.yaml
  Recording recording;
  TransferValidation transfer;
  std::optional<Refit> urdf;    ///< the robot as the calibrated URDF has it; nothing if frozen
  double expected_error = 0.0;  ///< of a robot that was never calibrated (ExpectedError), m
  bool frozen = false;          ///< whether nothing was fitted
  /// Of the recording, or contradictions to the calibration: its figures judge nothing.
  std::vector<std::string> mistakes;
  std::vector<std::string> not_judged;  ///< trials that cannot be used, a sentence each
  std::vector<std::string> warnings;    ///< what a user should know of, a sentence each
  /// Errors that the calibration expects, and what the recording shows, m: by the calibrated URDF,
  /// or by the calibrated model if frozen. Expected 0: the calibration left nothing out.
  double predicted = 0.0, shown = 0.0;
  std::vector<PlaceResidual> places = {};  ///< of markers that were measured on their links
  bool own_recording = false;              ///< whether the calibration was made from the recording

  bool converged() const;
  /// Whether the calibrated robot explains the recording better than the uncalibrated one, outliers
  /// included.
  bool better() const;
  /// Whether the calibrated robot errs by less than twice what one that was never calibrated is
  /// expected to: otherwise recording, project and calibration do not belong together.
  bool plausible() const;
  /// Whether the calibrated robot errs by no more than kWorseThanPredicted times what its
  /// calibration predicted; true where that predicted nothing.
  bool as_predicted() const;
};

/// Other days and other parts of the workspace bring somewhat more than held-out postures show.
inline constexpr double kWorseThanPredicted = 1.5;

struct TransferOptions {
  /// Fit nothing: waist and markers are those of the calibration (see ValidateFrozen).
  bool frozen = false;
  std::optional<std::uint64_t> seed = {};  ///< instead of the project's
  /// Mistakes of the recording to be corrected first, see AcceptMistakes.
  std::vector<std::string> accept = {};
  /// Where markers are on their links, as measured (ReadMarkerPlaces); empty: nobody knows. Both
  /// robots are fitted beside them, as they are stated.
  std::filesystem::path marker_places = {};
};

/// Applies a stored calibration to another recording of the same robot: only waist and markers are
/// fitted anew, for the calibrated and for the nominal robot (paper, section 6.1.4), or nothing.
/// Mistakes in a recording that explain its misfit are named (FindMistakesBy), and faults by which
/// it contradicts the calibration (FindTransferFaults).
///
/// `calibration`: the folder that calibrate wrote to, or its calibration.yaml. `recording`: a
/// posture table or a recording folder; trials for validation will do. Throws InputError: files
/// that cannot be read; a calibration of a robot with other nominal geometry than the project's;
/// places of markers where nothing is fitted.
ValidationRun ValidateCalibration(const Project& given, const std::filesystem::path& calibration,
                                  const std::filesystem::path& recording,
                                  const TransferOptions& options = {});

/// "better", "not better", "implausible" or "not converged".
std::string ValidationStatus(const ValidationRun& run);

/// validation.json: the figures for programs (docs/formats.md).
std::string MakeValidationJson(const ValidationRun& run);

}  // namespace elastocal
