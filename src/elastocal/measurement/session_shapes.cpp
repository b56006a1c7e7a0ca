// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/session_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "elastocal/math/numbers.hpp"

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
  double tolerance = 0.0;  ///< largest tolerance of the trials, m
};

/// The distance on which more than half of the trials agree, of at least `kLeastTrials`.
std::optional<double> MostFrequent(const PairSightings& of) {
  if (of.distances.size() < kLeastTrials) return std::nullopt;
  const double most = DensestMedian(of.distances, of.tolerance);
  const auto agree = std::count_if(of.distances.begin(), of.distances.end(), [&](double distance) {
    return std::abs(distance - most) <= of.tolerance;
  });
  if (2 * static_cast<std::size_t>(agree) <= of.distances.size()) return std::nullopt;
  return most;
}

/// The distance nearest to `nominal`, if all that differ from it are at least twice as far from
/// `nominal`.
std::optional<double> ClearlyNearest(const PairSightings& of, double nominal) {
  const double nearest = *std::min_element(
      of.distances.begin(), of.distances.end(),
      [&](double a, double b) { return std::abs(a - nominal) < std::abs(b - nominal); });
  for (const double other : of.distances) {
    if (std::abs(other - nearest) <= of.tolerance) continue;
    if (std::abs(other - nominal) < 2.0 * std::abs(nearest - nominal)) return std::nullopt;
  }
  return nearest;
}

}  // namespace

PairDistances UsualDistances(const std::vector<TrialSummary>& trials,
                             const PairDistances& nominal) {
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
    const auto by_project = nominal.find(pair);
    if (const auto most = MostFrequent(of)) {
      usual[pair] = *most;
    } else if (by_project != nominal.end()) {
      if (const auto nearest = ClearlyNearest(of, by_project->second)) usual[pair] = *nearest;
    }
  }
  return usual;
}

PairDistances NominalDistances(const MarkedRobot& robot) {
  PairDistances distances;
  for (const LabelCluster& cluster : robot.clusters) {
    for (std::size_t i = 0; i < cluster.markers.size(); ++i) {
      const Marker& a = robot.markers[Size(cluster.markers[i])];
      for (std::size_t j = i + 1; j < cluster.markers.size(); ++j) {
        const Marker& b = robot.markers[Size(cluster.markers[j])];
        distances[{a.name, b.name}] = (a.p_link_marker - b.p_link_marker).norm();
      }
    }
  }
  return distances;
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
