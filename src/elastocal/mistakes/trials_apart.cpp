// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/trials_apart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "elastocal/calibration/observations.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"

namespace elastocal {
namespace {

constexpr double kLeftApart = 0.5;     // of the error of one robot
constexpr double kLeastGain = 0.2e-3;  // m, of that error

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

/// Trials by themselves and together.
class TrialsTogether {
 public:
  TrialsTogether(const RecordedModel& robot, const Recording& recording,
                 const CalibrationResult& together, const CalibrationOptions& options)
      : robot_(robot), recording_(recording), kind_(together.kind), options_(options) {
    for (const PartOfRecording& trial : TrialsOf(recording)) {
      if (trial.postures.empty()) continue;
      const double alone = ErrorAlone(trial);
      if (std::isfinite(alone)) trials_.push_back({trial, alone});
    }
  }

  /// rms distance of the markers from a robot of its own for each trial, m.
  double ErrorApart() const { return ErrorApart(All()); }

  /// Sets of trials that one robot explains, but for an error of `most`, m; each as large as the
  /// order of the trials makes it.
  std::vector<std::vector<std::size_t>> Consistent(double most) const {
    std::vector<std::vector<std::size_t>> sets;
    std::vector<std::size_t> open = All();
    while (!open.empty()) {
      std::vector<std::size_t> set, others;
      for (const std::size_t trial : open) {
        set.push_back(trial);
        if (set.size() == 1 || ErrorOf(set) < most) continue;
        set.pop_back();
        others.push_back(trial);
      }
      sets.push_back(set);
      open = others;
    }
    std::ranges::stable_sort(sets,
                             [](const auto& a, const auto& b) { return a.size() > b.size(); });
    return sets;
  }

  /// rms distance of the markers from one robot for all these trials, m.
  double ErrorOf(const std::vector<std::size_t>& set) const {
    std::vector<int> postures;
    for (const std::size_t k : set) {
      postures.insert(postures.end(), trials_[k].part.postures.begin(),
                      trials_[k].part.postures.end());
    }
    std::ranges::sort(postures);
    const Recording part = SelectPostures(recording_, postures);
    return FitError(FitOf(part), part, options_);
  }

  std::string Names(const std::vector<std::size_t>& set) const {
    std::string names;
    for (const std::size_t k : set) names += (names.empty() ? "" : ", ") + trials_[k].part.name;
    return names;
  }

 private:
  struct TrialAlone {
    PartOfRecording part;
    double error = 0.0;
  };

  std::vector<std::size_t> All() const {
    std::vector<std::size_t> all(trials_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

  CalibrationResult FitOf(const Recording& part) const {
    return Calibrate(robot_.model, part, robot_.base, kind_, options_);
  }

  /// As large as the errors are that a fit of so many parameters leaves; infinite where the trial
  /// has too few equations.
  double ErrorAlone(const PartOfRecording& trial) const {
    const Recording part = SelectPostures(recording_, trial.postures);
    try {
      const CalibrationResult fit = FitOf(part);
      return FitError(fit, part, options_) * OfFreedom(fit, part);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  double ErrorApart(const std::vector<std::size_t>& set) const {
    std::vector<PartOfRecording> parts;
    std::vector<double> errors;
    for (const std::size_t k : set) {
      parts.push_back(trials_[k].part);
      errors.push_back(trials_[k].error);
    }
    return ErrorOverParts(recording_, parts, errors);
  }

  const RecordedModel& robot_;
  const Recording& recording_;
  ModelKind kind_;
  const CalibrationOptions& options_;
  std::vector<TrialAlone> trials_;
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

std::string FindTrialsApart(const RecordedModel& robot, const Recording& recording,
                            const CalibrationResult& together, const CalibrationOptions& options,
                            double left) {
  const TrialsTogether trials(robot, recording, together, options);
  const double apart = trials.ErrorApart();
  if (!AreApart(apart, left)) return "";
  const std::vector<std::vector<std::size_t>> sets = trials.Consistent(std::sqrt(apart * left));
  if (sets.size() < 2) return "";
  std::string explained;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    explained += fmt::format("{}{} ({:.3g} mm)", k == 0 ? "" : ", another one ",
                             trials.Names(sets[k]), 1e3 * trials.ErrorOf(sets[k]));
  }
  return fmt::format(
      "trials contradict each other: all together leave an error of {:.3g} mm, each by itself "
      "{:.3g} mm. One robot explains {}. Are they of different robots or days, or was the robot "
      "changed in between? Leave one set out, or measure it again",
      1e3 * left, 1e3 * apart, explained);
}

}  // namespace elastocal
