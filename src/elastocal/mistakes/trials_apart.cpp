// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/trials_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "elastocal/calibration/observations.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/collect_alike.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"

namespace elastocal {
namespace {

constexpr double kLeftApart = 0.5;       // ratio to the error of one robot
constexpr double kLeastGain = 0.2e-3;    // m, less than that error
constexpr double kMostOfSet = 3.0;       // ratio to the error of separate robots
constexpr std::size_t kMostTrials = 50;  // each is fitted by itself
constexpr int kFitsOfEach = 4;           // most fits of sets, times the number of trials

double CountSeen(const Recording& recording, const std::vector<int>& postures) {
  double seen = 0.0;
  for (const int i : postures) {
    for (int m = 0; m < recording.marker_count(); ++m) seen += Seen(recording, i, m) ? 1.0 : 0.0;
  }
  return seen;
}

std::vector<PartOfRecording> TrialsOf(const Recording& recording) {
  std::vector<PartOfRecording> trials(recording.trials.size());
  for (std::size_t t = 0; t < trials.size(); ++t) trials[t].name = recording.trials[t].name;
  for (int i = 0; i < std::ssize(recording.trial); ++i) {
    trials[Size(recording.trial[Size(i)])].postures.push_back(i);
  }
  return trials;
}

/// Factor by which the error exceeds the residual, because the fit adapts parameters. A body tells
/// six numbers in each posture (position and attitude), and its markers add at most six parameters.
/// The root link has six unknowns in each posture of a trial, and six in a whole table. A footing
/// has six unknowns, and tells six numbers in each posture in which the robot stands on it.
/// Infinite where there are as many parameters as numbers.
double OfFreedom(const CalibrationResult& fit, const Recording& part) {
  double rows = -6.0 * (fit.placement.empty() ? 1 : part.posture_count());
  std::set<int> footings;
  for (int i = 0; i < std::ssize(fit.placement.footing); ++i) {
    if (fit.placement.footing[Size(i)] < 0 || fit.tied[Size(i)] == 0) continue;
    footings.insert(fit.placement.footing[Size(i)]);
    rows += 6.0;
  }
  rows -= 6.0 * static_cast<double>(footings.size());
  std::map<int, double> of_markers;  // by body
  for (const BodyObservation& body : SelectAll(fit.model, part).bodies) {
    const auto told = static_cast<double>(std::min<Eigen::Index>(6, body.size()));
    rows += told;
    of_markers[body.body] = std::max(of_markers[body.body], told);
  }
  double fitted = 0.0;
  for (const auto& [body, told] : of_markers) fitted += told;
  for (int i = 0; i < fit.model.parameter_count(); ++i) {
    const bool told = fit.status[Size(i)] == ParameterStatus::kEstimated;
    if (told && !IsExternal(fit.model.parameters[Size(i)].kind)) fitted += 1.0;
  }
  return rows > fitted ? std::sqrt(rows / (rows - fitted))
                       : std::numeric_limits<double>::infinity();
}

/// Fits of the trials, separately and together.
class TrialsTogether {
 public:
  TrialsTogether(const RecordedModel& robot, const Recording& recording,
                 const CalibrationResult& together, const CalibrationOptions& options)
      : robot_(robot), recording_(recording), kind_(together.kind), options_(options) {
    for (const PartOfRecording& trial : TrialsOf(recording)) {
      if (trial.postures.empty()) continue;
      const double error =
          ErrorAlone(robot, SelectPostures(recording, trial.postures), kind_, options);
      if (!std::isfinite(error)) continue;
      trials_.push_back(trial);
      errors_.push_back(error);
    }
    if (trials_.size() < 2) return;
    const Recording judged = SelectPostures(recording, PosturesOf(trials_));
    left_ = MarkerError(together, judged, options);
    apart_ = ErrorOverParts(recording, trials_, errors_);
  }

  /// Errors of the markers with one robot, and with a separate robot for each trial, rms, m.
  double left() const { return left_; }
  double apart() const { return apart_; }

  /// Sets of trials that one robot explains with an error below `most`, m, or none (CollectAlike).
  std::optional<std::vector<AlikeSet>> Sets(double most) const {
    const int most_fits = kFitsOfEach * static_cast<int>(trials_.size());
    return CollectAlike(errors_, most, most_fits, [&](const std::vector<std::size_t>& set) {
      std::vector<PartOfRecording> together;
      for (const std::size_t k : set) together.push_back(trials_[k]);
      return ErrorOf(together);
    });
  }

  /// Names and error of each set.
  std::string Describe(const std::vector<AlikeSet>& sets) const {
    std::string said;
    for (const AlikeSet& set : sets) {
      std::string names;
      for (const std::size_t k : set.elements)
        names += (names.empty() ? "" : ", ") + trials_[k].name;
      said += fmt::format("{}{} ({:.3g} mm)", said.empty() ? "" : "; another one ", names,
                          1e3 * set.error);
    }
    return said;
  }

 private:
  static std::vector<int> PosturesOf(const std::vector<PartOfRecording>& trials) {
    std::vector<int> postures;
    for (const PartOfRecording& trial : trials) {
      postures.insert(postures.end(), trial.postures.begin(), trial.postures.end());
    }
    std::ranges::sort(postures);
    return postures;
  }

  double ErrorOf(const std::vector<PartOfRecording>& trials) const {
    const Recording part = SelectPostures(recording_, PosturesOf(trials));
    try {
      return FitError(Calibrate(robot_.model, part, robot_.base, kind_, options_), part, options_);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  const RecordedModel& robot_;
  const Recording& recording_;
  ModelKind kind_;
  const CalibrationOptions& options_;
  std::vector<PartOfRecording> trials_;
  std::vector<double> errors_;  // error of each trial by itself
  double left_ = 0.0, apart_ = 0.0;
};

}  // namespace

double ErrorOverParts(const Recording& recording, const std::vector<PartOfRecording>& parts,
                      const std::vector<double>& errors) {
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const double seen = CountSeen(recording, parts[k].postures);
    squares += seen * errors[k] * errors[k];
    count += seen;
  }
  return std::sqrt(squares / count);
}

bool AreApart(double error_apart, double error_together) {
  return error_apart < kLeftApart * error_together && error_apart < error_together - kLeastGain;
}

double ErrorAlone(const RecordedModel& robot, const Recording& part, ModelKind kind,
                  const CalibrationOptions& options) {
  try {
    const CalibrationResult fit = Calibrate(robot.model, part, robot.base, kind, options);
    return FitError(fit, part, options) * OfFreedom(fit, part);
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
}

std::optional<PartsApart> FindTrialsApart(const RecordedModel& robot, const Recording& recording,
                                          const CalibrationResult& together, double most,
                                          const CalibrationOptions& options) {
  if (recording.trials.size() > kMostTrials) return std::nullopt;
  const TrialsTogether trials(robot, recording, together, options);
  const double left = std::min(most, trials.left());
  if (!AreApart(trials.apart(), left)) return std::nullopt;
  const auto sets =
      trials.Sets(std::min(std::sqrt(trials.apart() * left), kMostOfSet * trials.apart()));
  if (sets && sets->size() < 2) return std::nullopt;
  const std::string said = fmt::format(
      "trials contradict each other: all together leave an error of {:.3g} mm, each by itself "
      "{:.3g} mm. {}. Are they of different robots or days, or was the robot "
      "changed in between? Leave the foreign ones out, or measure them again",
      1e3 * trials.left(), 1e3 * trials.apart(),
      sets ? "One robot explains " + trials.Describe(*sets) : "Few robots do not explain them");
  return PartsApart{said, trials.apart()};
}

}  // namespace elastocal
