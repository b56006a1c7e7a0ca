// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recordings_apart.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/screening/split_markers.hpp"

namespace elastocal {
namespace {

constexpr double kLeftApart = 0.5;      // of the error of one robot
constexpr double kLeastGain = 0.2e-3;   // m, of that error
constexpr double kLeftByMarkers = 1.5;  // of the error of the fits apart

/// What is from one of the folders given.
struct Folder {
  std::string name;
  std::vector<int> postures;
};

std::vector<Folder> FoldersOf(const Recording& recording) {
  std::vector<Folder> folders;
  for (int i = 0; i < std::ssize(recording.trial); ++i) {
    const Trial& trial = recording.trials[Size(recording.trial[Size(i)])];
    folders.resize(std::max(folders.size(), Size(trial.session) + 1));
    Folder& folder = folders[Size(trial.session)];
    folder.name = trial.name.substr(0, trial.name.find('/'));
    folder.postures.push_back(i);
  }
  std::erase_if(folders, [](const Folder& folder) { return folder.postures.empty(); });
  return folders;
}

/// rms distance of the markers of each folder from a robot of its own, m.
std::vector<double> ErrorsApart(const RecordedModel& robot, const Recording& recording,
                                const CalibrationResult& together,
                                const CalibrationOptions& options,
                                const std::vector<Folder>& folders) {
  std::vector<double> errors;
  for (const Folder& folder : folders) {
    const Recording part = SelectPostures(recording, folder.postures);
    errors.push_back(
        FitError(Calibrate(robot.model, part, robot.base, together.kind, options), part, options));
  }
  return errors;
}

double CountSeen(const Recording& recording, const std::vector<int>& postures) {
  double seen = 0.0;
  for (const int i : postures) {
    for (int m = 0; m < recording.marker_count(); ++m) seen += Seen(recording, i, m) ? 1.0 : 0.0;
  }
  return seen;
}

double RootMeanSquare(const Recording& recording, const std::vector<Folder>& folders,
                      const std::vector<double>& errors) {
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    const double seen = CountSeen(recording, folders[k].postures);
    squares += seen * errors[k] * errors[k];
    count += seen;
  }
  return std::sqrt(squares / count);
}

/// Gives what the folder shows of each marker, as far as others show it too, to a marker of its
/// own.
void GiveOwnMarkers(const Folder& folder, ErrorModel& model, Recording& recording) {
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

/// rms distance of the markers from one robot whose markers are elsewhere in each folder, m.
double ErrorWithOwnMarkers(const Project& project, const CalibrationResult& together,
                           Recording recording, const std::vector<Folder>& folders) {
  ErrorModel model = together.model;
  for (std::size_t k = 1; k < folders.size(); ++k) GiveOwnMarkers(folders[k], model, recording);
  const BaseParameters base = FindBaseOf(project, model, recording);
  return FitError(Calibrate(model, recording, base, together.kind, project.calibration), recording,
                  project.calibration);
}

}  // namespace

std::string FindRecordingsApart(const Project& project, const RecordedModel& robot,
                                const Recording& recording, const CalibrationResult& together) {
  const std::vector<Folder> folders = FoldersOf(recording);
  if (folders.size() < 2) return "";
  const CalibrationOptions& options = project.calibration;
  const double left = MarkerError(together, recording, options);
  try {
    const std::vector<double> errors = ErrorsApart(robot, recording, together, options, folders);
    const double apart = RootMeanSquare(recording, folders, errors);
    if (!(apart < kLeftApart * left && apart < left - kLeastGain)) return "";
    std::string each;
    for (std::size_t k = 0; k < folders.size(); ++k) {
      each += fmt::format("{}{} {:.3g} mm", k == 0 ? "" : ", ", folders[k].name, 1e3 * errors[k]);
    }
    const double by_markers = ErrorWithOwnMarkers(project, together, recording, folders);
    if (by_markers < kLeftByMarkers * apart) {
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
  } catch (const InputError&) {  // a part has too few equations
    return "";
  }
}

}  // namespace elastocal
