// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/placed_gains.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/screening/knocks.hpp"
#include "elastocal/screening/measured_faults.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {
namespace {

constexpr int kUpdatesOfPlaced = 15;
// Share of the gain: largest standard deviation in a trial that tells of it.
constexpr double kToldShare = 0.2;
constexpr double kLackedShare = 0.5;  // share of the gain: a trial that shows less does not have it

bool IsInAllTrials(const RecordingFault& fault) {
  return fault.kind == FaultKind::kJointGain && fault.coordinate >= 0 && fault.linkage < 0 &&
         fault.trial < 0;
}

}  // namespace

std::vector<RecordingFault> PlaceGains(const std::vector<RecordingFault>& faults,
                                       const Recording& undone, const GeneralFault& general) {
  const bool told = !undone.trials.empty() && general.held_out.posture_count() > 0;
  if (!told || std::none_of(faults.begin(), faults.end(), IsInAllTrials)) return faults;
  Recording held_out = WithThinnedMotions(general.held_out, undone.posture_count());
  AddUnseenMarkers(general.model, held_out);
  const Recording all = JoinTrials(undone, held_out);
  CalibrationOptions roughly = general.options;
  roughly.outliers = OutlierPolicy::kKeep;
  roughly.max_iterations = std::min(roughly.max_iterations, kUpdatesOfPlaced);
  std::vector<RecordingFault> placed;
  try {
    const CalibrationResult fit =
        Calibrate(general.model, all, general.base, general.kind, roughly);
    for (const RecordingFault& fault : faults) {
      std::vector<RecordingFault> there;
      bool lacked = false;
      if (IsInAllTrials(fault)) {
        for (const int trial : TrialsThatMove(all, fault.coordinate)) {
          RecordingFault one = fault;
          one.trial = trial;
          if (trial < std::ssize(undone.trials)) {
            there.push_back(one);
            continue;
          }
          const RecordingFault shown = MeasureFault(one, fit, all, general.options);
          lacked = lacked || (shown.sd < kToldShare * std::abs(fault.size) &&
                              std::abs(shown.size) < kLackedShare * std::abs(fault.size));
        }
      }
      if (!lacked || there.empty()) there = {fault};
      placed.insert(placed.end(), there.begin(), there.end());
    }
  } catch (const InputError&) {  // no trial tells
    return faults;
  }
  return placed;
}

}  // namespace elastocal
