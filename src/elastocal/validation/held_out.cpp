// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

/// Markers that are seen in a trial.
std::vector<int> MarkersOf(const ObservationMask& seen, const Recording& recording, int trial) {
  std::vector<int> markers;
  for (int m = 0; m < seen.cols(); ++m) {
    for (int i = 0; i < seen.rows(); ++i) {
      if (recording.trial[i] != trial || !seen(i, m)) continue;
      markers.push_back(m);
      break;
    }
  }
  return markers;
}

HeldOut Judge(const ModelComparison& comparison, const std::vector<ModelKind>& kinds,
              const Recording& recording, const CalibrationOptions& options) {
  HeldOut held_out;
  for (ModelKind kind : kinds) {
    const auto k = static_cast<int>(kind);
    const CalibrationResult& result = comparison.results[k];
    held_out.predictions[k] = Predict(result.model, result.delta, recording, options);
  }
  const ErrorModel& model = comparison.largest().model;
  const std::vector<std::string> groups = TrialGroups(model, recording);
  const ObservationMask seen = SeenMask(recording);
  std::vector<TrialErrors> trials;
  for (std::size_t t = 0; t < recording.trials.size(); ++t) {
    const int trial = static_cast<int>(t);
    const std::vector<int> postures = PosturesOfTrial(recording, trial);
    if (postures.empty()) continue;
    TrialResiduals residuals{recording.trials[t].name,
                             recording.trials[t].kind,
                             groups[t],
                             MarkersOf(seen, recording, trial),
                             {}};
    for (ModelKind kind : kinds) {
      residuals.distances[kind] =
          held_out.predictions[static_cast<int>(kind)].distances(postures, Eigen::all);
    }
    trials.push_back(ComputeTrialErrors(residuals));
  }
  held_out.table = MakeErrorTable(std::move(trials));
  return held_out;
}

}  // namespace

std::vector<std::string> TrialGroups(const ErrorModel& model, const Recording& recording) {
  const std::vector<int> group = NoiseGroups(model, recording);
  std::vector<std::vector<std::string>> chains_of_group;
  std::vector<int> group_of_trial(recording.trials.size(), -1);
  for (int i = 0; i < recording.posture_count(); ++i) {
    const int trial = recording.trial[i];
    group_of_trial[trial] = group[i];
    if (static_cast<int>(chains_of_group.size()) <= group[i]) chains_of_group.resize(group[i] + 1);
    std::vector<std::string>& chains = chains_of_group[group[i]];
    for (const std::string& chain : recording.trials[trial].chains) {
      if (std::find(chains.begin(), chains.end(), chain) == chains.end()) chains.push_back(chain);
    }
  }
  std::vector<std::string> names(recording.trials.size());
  for (std::size_t t = 0; t < names.size(); ++t) {
    if (group_of_trial[t] < 0) continue;
    for (const std::string& chain : chains_of_group[group_of_trial[t]]) {
      names[t] += (names[t].empty() ? "" : "+") + chain;
    }
  }
  return names;
}

HeldOut JudgeOnTrials(const ModelComparison& comparison, const Recording& recording,
                      const CalibrationOptions& options) {
  return Judge(comparison, comparison.kinds, recording, options);
}

HeldOut JudgeLargestOnTrials(const ModelComparison& comparison, const Recording& recording,
                             const CalibrationOptions& options) {
  return Judge(comparison, {comparison.largest_kind()}, recording, options);
}

ObservationMask Predicted(const HeldOut& held_out, ModelKind kind) {
  return held_out.predictions[static_cast<int>(kind)].distances.array().isFinite();
}

double WaistError(const Placement& predicted, const std::vector<std::optional<Transform>>& truth) {
  std::vector<std::size_t> free, standing;
  for (std::size_t i = 0; i < truth.size() && i < predicted.footing.size(); ++i) {
    if (!truth[i] || !predicted.T_ref_waist[i].matrix().allFinite()) continue;
    const int footing = predicted.footing[i];
    if (footing < 0) free.push_back(i);
    if (footing >= 0 && predicted.footings[footing].leg >= 0) standing.push_back(i);
  }
  if (standing.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::size_t>& reference = free.empty() ? standing : free;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (std::size_t i : reference) {
    shift += predicted.T_ref_waist[i].inverse() * truth[i]->translation();
  }
  shift /= static_cast<double>(reference.size());
  double squares = 0.0;
  for (std::size_t i : standing) {
    squares += (predicted.T_ref_waist[i] * shift - truth[i]->translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(standing.size()));
}

}  // namespace elastocal
