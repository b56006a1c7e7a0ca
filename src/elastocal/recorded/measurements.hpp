// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/foot_rests.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// The measurement vector of eq. 14: what cameras and robot recorded in one experiment, reduced to
/// samples (paper, section 5.1).
struct Measurements {
  Recording calibration;  ///< data for the estimate; each of its markers is seen in it
  Recording validation;  ///< trials of other kinds, with the markers of `calibration`; may be empty
  std::vector<TrialSummary> trials;  ///< for recording folders: what was used of each trial
  /// Feet at rest in all trials, also feet that stand beside others, whose markers are hidden in
  /// the recordings.
  std::vector<FootRest> foot_rests;
  /// True pose of the waist in each posture of `calibration` and `validation`, in the frame of the
  /// cameras, if a simulation wrote it. Empty for a posture table.
  std::vector<std::optional<Transform>> calibration_truth, validation_truth;
  std::vector<std::string> warnings;
};

/// The purpose for which recordings are read.
enum class ReadFor {
  kCalibration,  ///< trials of kind `calibration` are needed; the other kinds are kept apart
  /// All kinds of trials are accepted. If none is of kind `calibration`, the others become
  /// `calibration`; else a warning names the others.
  kAnyUse,
};

/// Reads one posture table (CSV), or one or more recording folders (with experiment.yaml).
///
/// In a folder, the markers and the robot's log of each trial are filtered alike, get one clock and
/// are reduced to stable samples (SampleTrial). The trials are then joined into one recording. A
/// posture table already holds such samples.
///
/// Throws InputError as ReadPostureTable and ReadRecordingFolders; for several recordings that are
/// not all folders; and with ReadFor::kCalibration for folders without a usable trial of kind
/// `calibration`.
Measurements ReadMeasurements(const Project& project,
                              const std::vector<std::filesystem::path>& recordings,
                              ReadFor purpose = ReadFor::kCalibration);

/// Names of the markers that were seen in some posture, in the recording's order.
std::vector<std::string> SeenMarkers(const Recording& recording);

/// All files that are read with a project and these recordings: project, URDF, tables, and for a
/// folder experiment.yaml with all files that it names. Throws as ReadExperiment.
std::vector<std::filesystem::path> InputFiles(const Project& project,
                                              const std::vector<std::filesystem::path>& recordings);

}  // namespace elastocal
