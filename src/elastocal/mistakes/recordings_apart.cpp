// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recordings_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "elastocal/calibration/observations.hpp"
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
constexpr double kFarAbove = 3.0;       // times what the cameras displace markers by
constexpr double kUsualNoise = 0.2e-3;  // m, of a coordinate (paper section 1)

/// What is of one trial, or from one of the folders given.
struct Part {
  std::string name;
  std::vector<int> postures;
};

std::vector<Part> TrialsOf(const Recording& recording) {
  std::vector<Part> trials(recording.trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t) trials[t].name = recording.trials[t].name;
  for (int i = 0; i < std::ssize(recording.trial); ++i) {
    trials[Size(recording.trial[Size(i)])].postures.push_back(i);
  }
  return trials;
}

std::vector<Part> FoldersOf(const Recording& recording) {
  std::vector<Part> folders;
  for (int i = 0; i < std::ssize(recording.trial); ++i) {
    const Trial& trial = recording.trials[Size(recording.trial[Size(i)])];
    folders.resize(std::max(folders.size(), Size(trial.session) + 1));
    Part& folder = folders[Size(trial.session)];
    folder.name = trial.name.substr(0, trial.name.find('/'));
    folder.postures.push_back(i);
  }
  std::erase_if(folders, [](const Part& folder) { return folder.postures.empty(); });
  return folders;
}

/// Distance by which the cameras displace a marker, rms of the best group, m. What contradicts
/// itself passes for noise: it is no more than usual cameras have.
double ScatterOfMarkers(const Noise& noise) {
  const double sd = noise.sd.col(static_cast<int>(NoiseSource::kMarker)).minCoeff();
  return std::sqrt(3.0) * std::min(sd, kUsualNoise);
}

/// rms distance of the markers of each folder from a robot of its own, m.
std::vector<double> ErrorsApart(const RecordedModel& robot, const Recording& recording,
                                const CalibrationResult& together,
                                const CalibrationOptions& options,
                                const std::vector<Part>& folders) {
  std::vector<double> errors;
  for (const Part& folder : folders) {
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

double RootMeanSquare(const Recording& recording, const std::vector<Part>& folders,
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
void GiveOwnMarkers(const Part& folder, ErrorModel& model, Recording& recording) {
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
                           Recording recording, const std::vector<Part>& folders) {
  ErrorModel model = together.model;
  for (std::size_t k = 1; k < folders.size(); ++k) GiveOwnMarkers(folders[k], model, recording);
  const BaseParameters base = FindBaseOf(project, model, recording);
  return FitError(Calibrate(model, recording, base, together.kind, project.calibration), recording,
                  project.calibration);
}

std::string DescribeFolders(const Project& project, const Recording& recording,
                            const CalibrationResult& together, const std::vector<Part>& folders,
                            const std::vector<double>& errors, double left, double apart) {
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
}

std::string FindFoldersApart(const Project& project, const RecordedModel& robot,
                             const Recording& recording, const CalibrationResult& together,
                             double left) {
  const std::vector<Part> folders = FoldersOf(recording);
  if (folders.size() < 2) return "";
  const std::vector<double> errors =
      ErrorsApart(robot, recording, together, project.calibration, folders);
  const double apart = RootMeanSquare(recording, folders, errors);
  if (!(apart < kLeftApart * left && apart < left - kLeastGain)) return "";
  return DescribeFolders(project, recording, together, folders, errors, left, apart);
}

/// By what a fit of so many parameters makes residuals smaller than errors are. Of a body its place
/// and attitude are told; infinite where the parameters are as many.
double OfFreedom(const CalibrationResult& fit, const Recording& part) {
  const Selection all = SelectAll(fit.model, part);
  double rows = -6.0 * part.posture_count();  // the waist's
  for (const BodyObservation& body : all.bodies) {
    rows += static_cast<double>(std::min<Eigen::Index>(6, body.size()));
  }
  const auto told =
      static_cast<double>(std::ranges::count(fit.status, ParameterStatus::kEstimated));
  return rows > told ? std::sqrt(rows / (rows - told)) : std::numeric_limits<double>::infinity();
}

/// What is left of all others without a trial that is another robot's, m; infinite if it is not.
struct WithoutTrial {
  double others = std::numeric_limits<double>::infinity(), alone = 0.0;
};

WithoutTrial TakeOut(const Part& trial, const RecordedModel& robot, const Recording& recording,
                     const CalibrationResult& together, const CalibrationOptions& options,
                     double left) {
  const auto fit_of = [&](const Recording& part) {
    return Calibrate(robot.model, part, robot.base, together.kind, options);
  };
  const Recording own = SelectPostures(recording, trial.postures);
  const CalibrationResult fit = fit_of(own);
  const double alone = FitError(fit, own, options) * OfFreedom(fit, own);
  if (!(alone < kLeftApart * MarkerError(together, own, options))) return {};
  std::vector<int> rest;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!std::binary_search(trial.postures.begin(), trial.postures.end(), i)) rest.push_back(i);
  }
  const Recording others = SelectPostures(recording, rest);
  const double without = FitError(fit_of(others), others, options);
  if (!(without < kLeftApart * left && without < left - kLeastGain)) return {};
  return {without, alone};
}

std::string FindTrialApart(const RecordedModel& robot, const Recording& recording,
                           const CalibrationResult& together, const CalibrationOptions& options,
                           double left) {
  const std::vector<Part> trials = TrialsOf(recording);
  if (trials.size() < 2) return "";
  WithoutTrial best;
  std::string name;
  for (const Part& trial : trials) {
    if (trial.postures.empty()) continue;
    try {
      const WithoutTrial without = TakeOut(trial, robot, recording, together, options, left);
      if (!(without.others < best.others)) continue;
      best = without;
      name = trial.name;
    } catch (const InputError&) {  // too few equations
      continue;
    }
  }
  if (name.empty()) return "";
  return fmt::format(
      "trial {} contradicts the others: with it the fit leaves an error of {:.3g} mm, without it "
      "{:.3g} mm, and in it alone {:.3g} mm. Is it of another robot or of another day, or was the "
      "robot changed before or after it? Leave it out, or measure it again",
      name, 1e3 * left, 1e3 * best.others, 1e3 * best.alone);
}

}  // namespace

std::string FindRecordingsApart(const Project& project, const RecordedModel& robot,
                                const Recording& recording, const CalibrationResult& together) {
  if (recording.trials.empty()) return "";
  const double left = MarkerError(together, recording, project.calibration);
  if (!(left > kFarAbove * ScatterOfMarkers(together.noise))) return "";
  try {
    const std::string folders = FindFoldersApart(project, robot, recording, together, left);
    if (!folders.empty()) return folders;
  } catch (const InputError&) {  // a folder has too few equations
  }
  return FindTrialApart(robot, recording, together, project.calibration, left);
}

}  // namespace elastocal
