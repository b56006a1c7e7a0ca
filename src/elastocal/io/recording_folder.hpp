// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/io/experiment.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// What cameras and robot recorded, as samples for the estimator.
struct RecordingFolder {
  Recording calibration;              ///< trials for estimation
  Recording validation;               ///< all other trials, by which the estimates are judged
  std::vector<TrialSummary> trials;   ///< all trials in the order of the files, refused ones too
  std::vector<std::string> findings;  ///< what a user should know, one sentence each
};

/// Whether there is an experiment.yaml in the folder.
bool IsRecordingFolder(const std::filesystem::path& path);

/// Reads the experiment.yaml of each folder with all files that it names, and takes samples from
/// each trial with Project::measurement (SampleTrial). With several folders, names of trials begin
/// with the folder's. Two threads; the result is the same with one.
///
/// Throws InputError: what ReadExperiment, ReadMarkerFile and ReadJointFile refuse; a joint that
/// moves a marker of a trial, but is neither logged nor given as not recorded; folders whose
/// cameras have different axes up; no trial with any posture.
RecordingFolder ReadRecordingFolders(const std::vector<std::filesystem::path>& folders,
                                     const Project& project);

/// Markers that take part in a trial, as ascending indices into Project::markers: those on the root
/// link's body, those of the chains that the trial exercises, and those on the bodies of its
/// supports, which tell the root's motion and whether a foot slipped. All others are left out.
/// Their joints balance the robot or are held, in postures chosen for other joints, and would only
/// add their errors.
std::vector<int> TrialMarkers(const Project& project, const TrialFiles& trial);

/// The robot of a project, for the processing of measurements.
MarkedRobot MakeMarkedRobot(const Project& project);

}  // namespace elastocal
