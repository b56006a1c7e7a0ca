// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Result of ValidateContacts.
struct ContactValidation {
  std::string calibration_file, calibration_fingerprint, recording;
  Observations observations;
  ObservedRobot model;
  /// Each posture was predicted by tables and trackers that the other postures place; if false, by
  /// those of the calibration.
  bool surroundings_refitted = false;
  ObservationFigures uncalibrated, calibrated;
  double gain_in_sds = 0.0;  ///< see GainInSds
  /// Reasons why the calibration does not hold: no gain in the sum of squares over the noise; kinds
  /// of observations that are clearly worse (WorseRows); errors of ten times what the calibration
  /// left and a tenth of LargestError; or, with tables and trackers registered anew, errors larger
  /// than those of any calibrated robot (LargeErrors). The first objection names the mistakes in
  /// the tables that explain them (FindObservedMistakes).
  std::vector<std::string> objections;
  std::vector<std::string> warnings;

  bool better() const { return objections.empty(); }
};

/// Predicts the observations of `recordings` (tables of observations and of corners) by a stored
/// calibration. Tables and trackers are where they were (`refit_table` false) or registered anew
/// (LeftAfterRegistration). Effects of sessions are taken as zero, because those of another day are
/// unknown. `accept` names mistakes that are corrected first (CorrectObservations). Throws
/// InputError for files that cannot be read, and for a calibration of another robot or without
/// touches.
ContactValidation ValidateContacts(const Project& project, const std::filesystem::path& calibration,
                                   const std::vector<std::filesystem::path>& recordings,
                                   bool refit_table, const std::vector<std::string>& accept = {});

/// validation.json: the figures for programs (docs/formats.md).
std::string MakeContactValidationJson(const ContactValidation& run);

}  // namespace elastocal
