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

/// The measurement vector of eq. 14: what cameras and robot recorded of one experiment, reduced to
/// samples (paper, section 5.1).
struct Measurements {
  Recording calibration;  ///< what parameters are estimated from; each of its markers is seen in it
  Recording validation;  ///< trials of other kinds, with the markers of `calibration`; may be empty
  std::vector<TrialSummary> trials;  ///< of recording folders: what was used of each trial
  /// Of all trials, also of feet beside others, whose markers the recordings do not have.
  std::vector<FootRest> foot_rests;
  /// True pose of the waist in each posture of `calibration` and `validation`, in the frame of the
  /// cameras, where a simulation wrote it. Empty for a posture table.
  std::vector<std::optional<Transform>> calibration_truth, validation_truth;
  std::vector<std::string> warnings;
};

/// What the recordings are read for.
enum class ReadFor {
  kCalibration,  ///< trials of kind `calibration` are needed; the other kinds are kept apart
  /// Any trials will do. Where none is of kind `calibration`, the others become `calibration`.
  kAnyUse,
};

/// Reads one posture table (CSV), or one or more recording folders (with experiment.yaml).
///
/// In a folder, the markers and the robot's log of each trial are filtered alike, brought to one
/// clock and reduced to stable samples (SampleTrial); then the trials are joined into one
/// recording. A posture table holds such samples already.
///
/// Throws InputError: what ReadPostureTable and ReadRecordingFolders refuse; several recordings
/// that are not all folders; with ReadFor::kCalibration folders without a usable trial of kind
/// `calibration`.
Measurements ReadMeasurements(const Project& project,
                              const std::vector<std::filesystem::path>& recordings,
                              ReadFor purpose = ReadFor::kCalibration);

/// Names of the markers that were seen in some posture, in the recording's order.
std::vector<std::string> SeenMarkers(const Recording& recording);

/// All files that are read with a project and these recordings: project, URDF, tables, and of a
/// folder experiment.yaml with all files that it names. Throws what ReadExperiment throws.
std::vector<std::filesystem::path> InputFiles(const Project& project,
                                              const std::vector<std::filesystem::path>& recordings);

}  // namespace elastocal
