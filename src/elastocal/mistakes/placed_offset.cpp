// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/placed_offset.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/trial_offset.hpp"
#include "elastocal/screening/measured_faults.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {
namespace {

constexpr double kPredictsBetter = 0.8;       // times the error on held-out trials: not by chance
constexpr double kExplainsAsWell = 1.1;       // times the error on the trials of the estimate
constexpr std::size_t kMostOtherTrials = 12;  // other trials; each takes a fit

/// The robot estimated without a fault, and what it leaves.
struct WithoutOffset {
  Recording recording;
  CalibrationResult fit;
  double left = 0.0;                     ///< rms distance of the markers, m
  std::optional<double> predicted = {};  ///< the same of held-out trials
};

WithoutOffset EstimateWithout(const RecordingFault& fault, const GeneralFault& general) {
  WithoutOffset without{WithoutFault(general.recording, fault), {}};
  without.fit =
      Calibrate(general.model, without.recording, general.base, general.kind, general.options);
  without.left = MarkerError(without.fit, without.recording, general.options);
  without.predicted = ErrorOnHeldOut(without.fit, general.base, general.held_out, general.options);
  return without;
}

/// The opposite offset in another trial, if that explains as much and predicts better.
std::optional<RecordingFault> InAnotherTrial(const RecordingFault& fault, const WithoutOffset& here,
                                             const GeneralFault& general) {
  std::optional<RecordingFault> found;
  double least = kExplainsAsWell * here.left;
  std::vector<int> others = AllTrialsThatMove(general.recording, fault.coordinate);
  std::erase(others, fault.trial);
  if (others.size() > kMostOtherTrials) others.resize(kMostOtherTrials);
  for (const int trial : others) {
    const auto first = std::ranges::find(general.recording.trial, trial);
    RecordingFault other = fault;
    other.trial = trial;
    other.posture = static_cast<int>(first - general.recording.trial.begin());
    other.size = -fault.size;
    const WithoutOffset there = EstimateWithout(other, general);
    if (!(there.left < least) || !there.predicted) continue;
    if (!(*there.predicted < kPredictsBetter * *here.predicted)) continue;
    least = there.left;
    const RecordingFault more = MeasureFault(other, there.fit, there.recording, general.options);
    other.size += more.size;
    other.sd = more.sd;
    found = other;
  }
  return found;
}

}  // namespace

PlacedOffset PlaceOffset(const RecordingFault& fault, const GeneralFault& general) {
  const bool tells = fault.kind == FaultKind::kJointOffset && fault.coordinate >= 0 &&
                     fault.linkage < 0 && fault.trial >= 0 && !general.fit &&
                     !IsInPartOfTrial(fault, general.recording) &&
                     general.held_out.posture_count() > 0;
  if (!tells) return {fault};
  try {
    const WithoutOffset here = EstimateWithout(fault, general);
    RecordingFault in_all = fault;
    in_all.trial = -1;
    in_all.posture = in_all.end = 0;
    const std::optional<double> shifted = ErrorOnHeldOut(
        here.fit, general.base, WithoutFault(general.held_out, in_all), general.options);
    if (!here.predicted || !shifted) return {fault};
    if (*here.predicted < kPredictsBetter * *shifted) return {fault, true};
    if (!(*shifted < kPredictsBetter * *here.predicted)) return {fault};
    const auto other = InAnotherTrial(fault, here, general);
    return other ? PlacedOffset{*other, true} : PlacedOffset{fault, false, true};
  } catch (const InputError&) {  // nothing is told
    return {fault};
  }
}

}  // namespace elastocal
