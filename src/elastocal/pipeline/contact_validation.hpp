// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A calibration on observations of another day.
struct ContactValidation {
  std::string calibration_file, calibration_fingerprint, recording;
  Observations observations;
  ObservedRobot model;
  /// Whether each posture was predicted by tables and trackers that the others of the file place;
  /// else by those of the calibration.
  bool surroundings_refitted = false;
  ObservationFigures uncalibrated, calibrated;
  double gain_in_sds = 0.0;  ///< see GainInSds
  /// No gain in the sum of squares over the noise; kinds of observations that are clearly worse
  /// (WorseRows), off by ten times what the calibration left and by a tenth of LargestError or,
  /// with the surroundings registered anew, by more than any calibrated robot is (LargeErrors). The
  /// first names mistakes in the tables that explain them (FindObservedMistakes).
  std::vector<std::string> objections;
  std::vector<std::string> warnings;

  bool better() const { return objections.empty(); }
};

/// Predicts the observations of `recordings` (tables of observations and of corners) by a stored
/// calibration, with the surroundings where they were
/// (`refit_table` false) or registered anew (LeftAfterRegistration). Sessions of another day are
/// unknown: they have no effect. `accept`: mistakes that are corrected first (CorrectObservations).
/// Throws InputError: files that cannot be read; a calibration of
/// another robot or without touches.
ContactValidation ValidateContacts(const Project& project, const std::filesystem::path& calibration,
                                   const std::vector<std::filesystem::path>& recordings,
                                   bool refit_table, const std::vector<std::string>& accept = {});

/// validation.json: the figures for programs (docs/formats.md).
std::string MakeContactValidationJson(const ContactValidation& run);

}  // namespace elastocal
