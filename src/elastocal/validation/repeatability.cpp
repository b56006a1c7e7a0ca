// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace elastocal {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

using Repetitions = std::vector<std::vector<int>>;

void CheckMarkers(const Recording& recording, const std::vector<int>& markers) {
  const bool known = std::all_of(markers.begin(), markers.end(),
                                 [&](int m) { return m >= 0 && m < recording.marker_count(); });
  if (markers.empty() || !known) {
    throw std::invalid_argument("AssessRepeatability: no such cluster of markers");
  }
}

bool SamePosture(const Recording& recording, int i, int j, const RepeatabilityOptions& options) {
  const Eigen::VectorXd difference = (recording.q.row(i) - recording.q.row(j)).cwiseAbs();
  if (options.coordinates.empty()) return difference.maxCoeff() <= options.same_posture;
  return difference(options.coordinates).maxCoeff() <= options.same_posture;
}

bool SameHold(const Recording& recording, int before, int i, double longest_gap_s) {
  if (recording.time_s.size() == 0) return false;
  if (!recording.trial.empty() && recording.trial[before] != recording.trial[i]) return false;
  return recording.time_s[i] - recording.time_s[before] <= longest_gap_s;
}

/// Groups samples by posture and repetition. The first sample of a posture defines the posture.
std::vector<Repetitions> GroupSamples(const Recording& recording,
                                      const RepeatabilityOptions& options) {
  std::vector<Repetitions> postures;
  std::size_t last = 0;  // posture of the sample before
  for (int i = 0; i < recording.posture_count(); ++i) {
    const auto same =
        std::find_if(postures.begin(), postures.end(), [&](const Repetitions& repetitions) {
          return SamePosture(recording, repetitions.front().front(), i, options);
        });
    const auto posture = static_cast<std::size_t>(same - postures.begin());
    if (same == postures.end()) postures.emplace_back();
    const bool goes_on =
        i > 0 && posture == last && SameHold(recording, i - 1, i, options.longest_hold_gap_s);
    if (!goes_on) postures[posture].emplace_back();
    postures[posture].back().push_back(i);
    last = posture;
  }
  return postures;
}

bool SeenInAny(const Recording& recording, const std::vector<int>& samples, int marker) {
  return std::any_of(samples.begin(), samples.end(),
                     [&](int i) { return Seen(recording, i, marker); });
}

std::vector<int> SeenOf(const Recording& recording, const std::vector<int>& samples,
                        const std::vector<int>& markers) {
  std::vector<int> seen;
  std::copy_if(markers.begin(), markers.end(), std::back_inserter(seen),
               [&](int m) { return SeenInAny(recording, samples, m); });
  return seen;
}

/// Centre of the markers, each averaged over the samples that show it; NaN if one is never seen.
Eigen::Vector3d Centre(const Recording& recording, const std::vector<int>& samples,
                       const std::vector<int>& markers) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int m : markers) {
    Eigen::Vector3d marker_sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const int i : samples) {
      if (!Seen(recording, i, m)) continue;
      marker_sum += MarkerPosition(recording, i, m);
      ++count;
    }
    sum += marker_sum / count;
  }
  return sum / static_cast<double>(markers.size());
}

double Distance(const Recording& recording, const std::vector<int>& samples,
                const RepeatedPosture& posture) {
  return (Centre(recording, samples, posture.waist_markers) -
          Centre(recording, samples, posture.effector_markers))
      .norm();
}

/// Scatter of the samples within repetitions.
struct Scatter {
  double squares = 0.0;
  int freedom = 0;
};

/// Adds the scatter of the samples that show all markers of the posture. It is due to noise alone.
void AddScatter(const Recording& recording, const std::vector<int>& samples,
                const RepeatedPosture& posture, Scatter& scatter) {
  std::vector<double> distances;
  for (const int i : samples) {
    const double distance = Distance(recording, {i}, posture);
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  if (distances.size() < 2) return;
  const Eigen::Map<const Eigen::VectorXd> d(distances.data(),
                                            static_cast<Eigen::Index>(distances.size()));
  scatter.squares += (d.array() - d.mean()).square().sum();
  scatter.freedom += static_cast<int>(d.size()) - 1;
}

/// Removes repetitions that show too few markers, and selects the markers that the others have in
/// common.
RepeatedPosture ChooseMarkers(const Recording& recording, const Repetitions& repetitions,
                              const std::vector<int>& waist, const std::vector<int>& effector,
                              Repeatability& result) {
  RepeatedPosture posture;
  posture.waist_markers = waist;
  posture.effector_markers = effector;
  for (const std::vector<int>& samples : repetitions) {
    if (2 * SeenOf(recording, samples, waist).size() < waist.size() ||
        2 * SeenOf(recording, samples, effector).size() < effector.size()) {
      ++result.left_out;
      continue;
    }
    posture.samples.push_back(samples);
    posture.waist_markers = SeenOf(recording, samples, posture.waist_markers);
    posture.effector_markers = SeenOf(recording, samples, posture.effector_markers);
  }
  return posture;
}

void Summarise(const Recording& recording, Repeatability& result) {
  std::vector<double> deviations;
  double squares = 0.0;
  double inverse_counts = 0.0;  // of the number of samples in a repetition
  Scatter scatter;
  for (const RepeatedPosture& posture : result.postures) {
    const double mean = posture.distances.mean();
    for (const double distance : posture.distances) {
      deviations.push_back(std::abs(distance - mean));
      squares += std::pow(distance - mean, 2);
    }
    for (const std::vector<int>& samples : posture.samples) {
      AddScatter(recording, samples, posture, scatter);
      inverse_counts += 1.0 / static_cast<double>(samples.size());
    }
  }
  result.repetitions = static_cast<int>(deviations.size());
  result.mean_deviation = result.sd_deviation = result.distance_sd = result.noise_sd = kNone;
  if (deviations.empty()) return;
  const Eigen::Map<const Eigen::ArrayXd> d(deviations.data(), result.repetitions);
  result.mean_deviation = d.mean();
  result.sd_deviation =
      std::sqrt((d - d.mean()).square().sum() / static_cast<double>(result.repetitions - 1));
  const auto posture_count = static_cast<int>(result.postures.size());
  result.distance_sd = std::sqrt(squares / (result.repetitions - posture_count));
  if (scatter.freedom == 0) return;
  result.noise_sd = std::sqrt(scatter.squares / scatter.freedom * inverse_counts /
                              static_cast<double>(result.repetitions));
}

}  // namespace

Repeatability AssessRepeatability(const Recording& recording, const std::vector<int>& waist_markers,
                                  const std::vector<int>& effector_markers,
                                  const RepeatabilityOptions& options) {
  CheckMarkers(recording, waist_markers);
  CheckMarkers(recording, effector_markers);
  Repeatability result;
  for (const Repetitions& repetitions : GroupSamples(recording, options)) {
    RepeatedPosture posture =
        ChooseMarkers(recording, repetitions, waist_markers, effector_markers, result);
    const auto count = static_cast<Eigen::Index>(posture.samples.size());
    if (count < 2 || posture.waist_markers.empty() || posture.effector_markers.empty()) {
      ++result.not_repeated;
      continue;
    }
    posture.distances.resize(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      posture.distances[k] = Distance(recording, posture.samples[k], posture);
    }
    result.postures.push_back(std::move(posture));
  }
  Summarise(recording, result);
  return result;
}

}  // namespace elastocal
