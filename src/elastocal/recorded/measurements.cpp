// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/measurements.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "elastocal/calibration/closed_chains.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/io/waist_truth.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/trial_names.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// The recording with the markers of these names, in this order; a marker that it lacks is not
/// seen. Postures in which no marker is seen are left out.
Recording WithMarkers(const Recording& recording, const std::vector<std::string>& names) {
  Recording selected = recording;
  selected.marker_names = names;
  selected.markers.setConstant(recording.posture_count(),
                               3 * static_cast<Eigen::Index>(names.size()),
                               std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at =
        std::find(recording.marker_names.begin(), recording.marker_names.end(), names[k]);
    if (at == recording.marker_names.end()) continue;
    selected.markers.middleCols<3>(3 * static_cast<Eigen::Index>(k)) =
        recording.markers.middleCols<3>(3 * (at - recording.marker_names.begin()));
  }
  const ObservationMask seen = SeenMask(selected);
  std::vector<int> postures;
  for (int i = 0; i < selected.posture_count(); ++i) {
    if (seen.row(i).any()) postures.push_back(i);
  }
  return SelectPostures(selected, postures);
}

/// Warns of markers that only trials for validation show, for which the model has no position.
void WarnOfOtherMarkers(const std::vector<std::string>& known, const Recording& validation,
                        std::vector<std::string>& warnings) {
  std::string others;
  for (const std::string& name : SeenMarkers(validation)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    others += (others.empty() ? "" : ", ") + name;
  }
  if (others.empty()) return;
  warnings.push_back("markers seen in trials for validation only, not judged: " + others);
}

/// True poses of the waist at the times of the postures, for trials with a file of them.
std::vector<std::optional<Transform>> TrueWaists(const std::vector<fs::path>& folders,
                                                 const Project& project,
                                                 const Recording& recording) {
  std::vector<std::optional<Transform>> waists(recording.posture_count());
  for (std::size_t session = 0; session < folders.size(); ++session) {
    for (const TrialFiles& files : ReadExperiment(folders[session], project).trials) {
      if (files.truth.empty()) continue;
      const WaistTruth truth = ReadWaistTruth(files.truth);
      for (int i = 0; i < recording.posture_count(); ++i) {
        const Trial& trial = recording.trials[recording.trial[i]];
        const bool same = folders.size() == 1
                              ? trial.name == files.name
                              : trial.session == static_cast<int>(session) &&
                                    trial.name.substr(trial.name.find('/') + 1) == files.name;
        if (!same || truth.time_s.size() == 0) continue;
        Eigen::Index nearest = 0;
        (truth.time_s.array() - recording.time_s[i]).abs().minCoeff(&nearest);
        waists[i] = truth.T_camera_waist[static_cast<std::size_t>(nearest)];
      }
    }
  }
  return waists;
}

/// Number of a trial among all that were read. (In the recordings for calibration and for
/// validation, trials do not follow each other as in their folder.)
int NumberAmong(const std::vector<TrialSummary>& trials, const Trial& trial) {
  const auto found = std::ranges::find(
      trials, trial.name, [](const TrialSummary& summary) { return summary.trial.name; });
  return static_cast<int>(found - trials.begin());
}

[[noreturn]] void RefuseWithoutCalibration(const RecordingFolder& read) {
  std::string message = read.validation.source +
                        ": no trial of kind 'calibration' can be used, only such of other kinds, "
                        "which are for validation; a folder with trials for calibration was "
                        "expected as well";
  for (const TrialSummary& trial : read.trials) {
    if (trial.trial.kind != TrialKind::kCalibration || trial.refused.empty()) continue;
    message += " (trial '" + trial.trial.name + "': " + trial.refused + ")";
  }
  throw InputError(message);
}

/// Warns of trials for validation that are left out beside those for calibration.
void WarnOfUnusedTrials(RecordingFolder& read) {
  const Recording& others = read.validation;
  const std::set<int> used(others.trial.begin(), others.trial.end());
  if (used.empty()) return;
  read.findings.push_back(
      "not used here: " + TrialNames(others, {used.begin(), used.end()}) +
      ", because beside trials of kind 'calibration' those of other kinds are left out; to use "
      "them, name them alone in the experiment.yaml of another folder");
}

Measurements ReadFolders(const std::vector<fs::path>& folders, const Project& project,
                         ReadFor purpose) {
  RecordingFolder read = ReadRecordingFolders(folders, project);
  if (read.calibration.posture_count() == 0) {
    if (purpose == ReadFor::kCalibration) RefuseWithoutCalibration(read);
    std::swap(read.calibration, read.validation);
  } else if (purpose == ReadFor::kAnyUse) {
    WarnOfUnusedTrials(read);
  }
  Measurements measured;
  for (Recording* recording : {&read.calibration, &read.validation}) {
    NoteApproach(*recording);
    for (FootRest& rest : FindFootRests(project.tree, project.markers, *recording)) {
      rest.trial =
          NumberAmong(read.trials, recording->trials[static_cast<std::size_t>(rest.trial)]);
      measured.foot_rests.push_back(std::move(rest));
    }
    HideClosedChains(project.tree, project.markers, *recording);
  }
  std::ranges::stable_sort(measured.foot_rests, {}, &FootRest::trial);
  measured.trials = std::move(read.trials);
  measured.warnings = std::move(read.findings);
  const std::vector<std::string> seen = SeenMarkers(read.calibration);
  measured.calibration = WithMarkers(read.calibration, seen);
  measured.calibration_truth = TrueWaists(folders, project, measured.calibration);
  if (read.validation.posture_count() > 0) {
    WarnOfOtherMarkers(seen, read.validation, measured.warnings);
    measured.validation = WithMarkers(read.validation, seen);
    measured.validation_truth = TrueWaists(folders, project, measured.validation);
  }
  return measured;
}

/// Refuses a folder that is no recording, with a message about what was expected.
void ExpectNoFolder(const fs::path& recording) {
  std::error_code error;
  if (!fs::is_directory(recording, error)) return;
  if (IsBagFolder(recording)) {
    throw InputError(recording.string() +
                     ": this is the folder of a ROS bag; it needs a folder with experiment.yaml, "
                     "which names it (docs/formats.md, Recording folder)");
  }
  throw InputError(recording.string() +
                   ": no experiment.yaml in this folder; expected a recording folder, which has "
                   "one, or the file of a posture table");
}

}  // namespace

std::vector<std::string> SeenMarkers(const Recording& recording) {
  std::vector<std::string> seen;
  const ObservationMask mask = SeenMask(recording);
  for (int m = 0; m < mask.cols(); ++m) {
    if (mask.col(m).any()) seen.push_back(recording.marker_names[m]);
  }
  return seen;
}

Measurements ReadMeasurements(const Project& project, const std::vector<fs::path>& recordings,
                              ReadFor purpose) {
  if (std::any_of(recordings.begin(), recordings.end(), IsRecordingFolder)) {
    return ReadFolders(recordings, project, purpose);
  }
  if (recordings.empty()) throw InputError("no recording; one or more were expected");
  if (recordings.size() > 1) {
    throw InputError(recordings[1].string() +
                     ": no experiment.yaml in it; only recording folders can be taken together");
  }
  ExpectNoFolder(recordings[0]);
  PostureTable table = ReadPostureTable(recordings[0], project);
  Measurements measured;
  measured.calibration = std::move(table.recording);
  NoteApproach(measured.calibration);
  measured.warnings = std::move(table.warnings);
  return measured;
}

std::vector<fs::path> InputFiles(const Project& project, const std::vector<fs::path>& recordings) {
  std::vector<fs::path> files = {project.file, project.urdf};
  if (project.contact) {
    const std::vector<fs::path> tables = ObservationFiles(recordings);
    files.insert(files.end(), tables.begin(), tables.end());
    return files;
  }
  for (const fs::path& recording : recordings) {
    if (!IsRecordingFolder(recording)) {
      ExpectNoFolder(recording);
      files.push_back(recording);
      continue;
    }
    files.push_back(recording / "experiment.yaml");
    for (const TrialFiles& trial : ReadExperiment(recording, project).trials) {
      for (const fs::path& one : {trial.markers, trial.joints}) {
        const std::vector<fs::path> read = FilesOfRecording(one);
        files.insert(files.end(), read.begin(), read.end());
      }
      if (!trial.truth.empty()) files.push_back(trial.truth);
    }
  }
  return files;
}

}  // namespace elastocal
