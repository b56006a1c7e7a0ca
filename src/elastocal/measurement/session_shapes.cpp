// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/session_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace elastocal {
namespace {

constexpr std::size_t kLeastTrials = 3;

/// Calls `use(pair of names, distance, tolerance)` for each pair of a cluster whose distance is
/// known.
template <typename Use>
void ForEachPair(const TrialSummary& trial, const Use& use) {
  for (const ClusterLabels& cluster : trial.labels) {
    const int size = static_cast<int>(cluster.markers.size());
    if (cluster.distances.size() != size * (size - 1) / 2) continue;
    const auto name = [&](int i) {
      return trial.markers[static_cast<std::size_t>(cluster.markers[static_cast<std::size_t>(i)])];
    };
    for (int i = 0; i < size; ++i) {
      for (int j = i + 1; j < size; ++j) {
        const int pair = PairColumn(i, j, size);
        if (std::isnan(cluster.distances[pair])) continue;
        use(std::pair(name(i), name(j)), cluster.distances[pair], cluster.tolerances[pair]);
      }
    }
  }
}

struct PairSightings {
  std::vector<double> distances;
  double tolerance = 0.0;  ///< the largest
};

}  // namespace

PairDistances UsualDistances(const std::vector<TrialSummary>& trials) {
  std::map<std::pair<std::string, std::string>, PairSightings> seen;
  for (const TrialSummary& trial : trials) {
    ForEachPair(trial, [&](const auto& pair, double distance, double tolerance) {
      PairSightings& of = seen[pair];
      of.distances.push_back(distance);
      of.tolerance = std::max(of.tolerance, tolerance);
    });
  }
  PairDistances usual;
  for (const auto& [pair, of] : seen) {
    if (of.distances.size() < kLeastTrials) continue;
    const double most = DensestMedian(of.distances, of.tolerance);
    const auto agree = std::count_if(
        of.distances.begin(), of.distances.end(),
        [&, &of = of](double distance) { return std::abs(distance - most) <= of.tolerance; });
    if (2 * static_cast<std::size_t>(agree) > of.distances.size()) usual[pair] = most;
  }
  return usual;
}

bool DiffersFromUsual(const TrialSummary& trial, const PairDistances& usual) {
  bool differs = false;
  ForEachPair(trial, [&](const auto& pair, double distance, double tolerance) {
    const auto found = usual.find(pair);
    if (found != usual.end() && std::abs(distance - found->second) > tolerance) differs = true;
  });
  return differs;
}

}  // namespace elastocal
