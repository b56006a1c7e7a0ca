// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/known_soles.hpp"

#include <algorithm>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/measurement/weight_shares.hpp"
#include "elastocal/pipeline/calibration_files.hpp"

namespace elastocal {
namespace {

/// For each trial that was read: its number in a recording; -1: it is in another.
std::vector<int> TrialsIn(const Recording& recording, const std::vector<TrialSummary>& trials) {
  std::vector<int> numbers;
  for (const TrialSummary& read : trials) {
    const auto found = std::ranges::find(recording.trials, read.trial.name, &Trial::name);
    numbers.push_back(
        found == recording.trials.end() ? -1 : static_cast<int>(found - recording.trials.begin()));
  }
  return numbers;
}

}  // namespace

std::vector<SoleSpring> KnownSoles(const Project& project, const CalibrationResult& result,
                                   const Measurements& measured,
                                   const std::filesystem::path& earlier) {
  std::vector<FootRest> rests = measured.foot_rests;
  for (const Recording* recording : {&measured.calibration, &measured.validation}) {
    if (rests.empty()) break;
    ShareWeights(project.tree, project.markers, *recording, TrialsIn(*recording, measured.trials),
                 rests);
  }
  std::vector<SoleSpring> soles = EstimateSoleSprings(result, rests, measured.calibration.gravity);
  if (earlier.empty()) return soles;
  const StoredCalibration stored = ReadCalibration(FindCalibrationFiles(earlier).calibration);
  for (SoleSpring& sole : soles) {
    for (const SoleSpring& known : stored.soles) {
      if (known.leg == sole.leg && known.told() && !sole.told()) sole = known;
    }
  }
  return soles;
}

}  // namespace elastocal
