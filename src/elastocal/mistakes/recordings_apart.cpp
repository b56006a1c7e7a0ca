// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recordings_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/screening/split_markers.hpp"

namespace elastocal {
namespace {

constexpr double kLeftByMarkers = 1.5;  // ratio to the error of the separate fits
constexpr double kFarAbove = 3.0;       // ratio to the noise of the cameras
constexpr double kUsualNoise = 0.2e-3;  // m, of a coordinate (paper section 1)

std::vector<PartOfRecording> FoldersOf(const Recording& recording) {
  std::vector<PartOfRecording> folders;
  for (int i = 0; i < std::ssize(recording.trial); ++i) {
    const Trial& trial = recording.trials[Size(recording.trial[Size(i)])];
    folders.resize(std::max(folders.size(), Size(trial.session) + 1));
    PartOfRecording& folder = folders[Size(trial.session)];
    folder.name = trial.name.substr(0, trial.name.find('/'));
    folder.postures.push_back(i);
  }
  std::erase_if(folders, [](const PartOfRecording& folder) { return folder.postures.empty(); });
  return folders;
}

/// Noise of the cameras as rms displacement of a marker, in the best group, m; at most that of
/// usual cameras, because contradictions look like noise.
double ScatterOfMarkers(const Noise& noise) {
  const double sd = noise.sd.col(static_cast<int>(NoiseSource::kMarker)).minCoeff();
  return std::sqrt(3.0) * std::min(sd, kUsualNoise);
}

/// Moves the observations of each marker in the folder to a new marker, where other folders show
/// that marker, too.
void GiveOwnMarkers(const PartOfRecording& folder, ErrorModel& model, Recording& recording) {
  std::vector<char> there(Size(recording.posture_count()), 0);
  for (const int i : folder.postures) there[Size(i)] = 1;
  std::vector<int> markers;
  std::vector<std::string> names;
  for (int m = 0; m < recording.marker_count(); ++m) {
    int inside = 0, outside = 0;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (Seen(recording, i, m)) ++(there[Size(i)] != 0 ? inside : outside);
    }
    if (inside == 0 || outside == 0) continue;
    markers.push_back(m);
    names.push_back(recording.marker_names[Size(m)] + "(" + folder.name + ")");
  }
  SplitMarkersOf(markers, names, there, model, recording);
}

}  // namespace

double ErrorWithOwnMarkers(const Project& project, const CalibrationResult& together,
                           Recording recording, const std::vector<PartOfRecording>& parts) {
  ErrorModel model = together.model;
  for (std::size_t k = 1; k < parts.size(); ++k) GiveOwnMarkers(parts[k], model, recording);
  try {
    const BaseParameters base = FindBaseOf(project, model, recording);
    return FitError(Calibrate(model, recording, base, together.kind, project.calibration),
                    recording, project.calibration);
  } catch (const InputError&) {  // too many markers for the equations
    return std::numeric_limits<double>::infinity();
  }
}

bool AreMarkersApart(double by_markers, double apart) {
  return by_markers < kLeftByMarkers * apart;
}

namespace {

std::string DescribeFolders(const Project& project, const Recording& recording,
                            const CalibrationResult& together,
                            const std::vector<PartOfRecording>& folders,
                            const std::vector<double>& errors, double left, double apart) {
  std::string each;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    each += fmt::format("{}{} {:.3g} mm", k == 0 ? "" : ", ", folders[k].name, 1e3 * errors[k]);
  }
  const double by_markers = ErrorWithOwnMarkers(project, together, recording, folders);
  if (AreMarkersApart(by_markers, apart)) {
    return fmt::format(
        "the markers of the recordings are not in the same places: one robot leaves an error of "
        "{:.3g} mm, and {:.3g} mm where each recording has markers of its own. Give markers that "
        "were glued on anew other names, or calibrate by one recording with the other's result "
        "as --prior",
        1e3 * left, 1e3 * by_markers);
  }
  return fmt::format(
      "the recordings are not of one robot in one state: together they leave an error of {:.3g} "
      "mm, each by itself {}. Are they of different robots, or was the robot changed between "
      "them? Calibrate each by itself; `elastocal compare` says what differs",
      1e3 * left, each);
}

std::optional<PartsApart> FindFoldersApart(const Project& project, const RecordedModel& robot,
                                           const Recording& recording,
                                           const CalibrationResult& together, double most) {
  std::vector<PartOfRecording> folders = FoldersOf(recording);
  if (folders.size() < 2) return std::nullopt;
  std::vector<double> errors;
  std::erase_if(folders, [&](const PartOfRecording& folder) {
    const double error = ErrorAlone(robot, SelectPostures(recording, folder.postures),
                                    together.kind, project.calibration);
    if (std::isfinite(error)) errors.push_back(error);
    return !std::isfinite(error);
  });
  if (folders.size() < 2) return std::nullopt;
  std::vector<int> judged;
  for (const PartOfRecording& folder : folders) {
    judged.insert(judged.end(), folder.postures.begin(), folder.postures.end());
  }
  std::ranges::sort(judged);
  const double left = MarkerError(together, SelectPostures(recording, judged), project.calibration);
  const double apart = ErrorOverParts(recording, folders, errors);
  if (!AreApart(apart, std::min(most, left))) return std::nullopt;
  return PartsApart{DescribeFolders(project, recording, together, folders, errors, left, apart),
                    apart};
}

}  // namespace

bool LeavesMoreThanCameras(const CalibrationResult& result, double left) {
  return left > kFarAbove * ScatterOfMarkers(result.noise);
}

std::optional<PartsApart> FindRecordingsApart(const Project& project, const RecordedModel& robot,
                                              const Recording& recording,
                                              const CalibrationResult& together, double most) {
  if (recording.trials.empty()) return std::nullopt;
  const auto folders = FindFoldersApart(project, robot, recording, together, most);
  if (folders) return folders;
  return FindTrialsApart(robot, recording, together, most, project.calibration);
}

}  // namespace elastocal
