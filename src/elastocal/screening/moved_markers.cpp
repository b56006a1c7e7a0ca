// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/moved_markers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr int kFewestOnSide = 4;             // postures on each side
constexpr double kLeastStepOfMarker = 1e-3;  // m
constexpr double kLeastOfScatter = 3.0;
constexpr double kLeastOfLargest = 0.1;  // smallest step of a distance, relative to the largest
constexpr double kOthersStay = 0.3;      // largest step of other distances, relative to these
constexpr std::size_t kFewestSteps = 2;
constexpr int kSplitsOfTable = 60;  // postures that are tried first

/// Step of the distance of two markers at a posture, m.
struct DistanceStep {
  double size = 0.0;
  double scatter = 0.0;  ///< scatter about either side, by medians
  double spread = 0.0;   ///< the same, by means
};

/// The step; nothing where the distance was not seen often enough on either side.
std::optional<DistanceStep> StepAt(const Recording& recording, int a, int b, int posture) {
  std::vector<double> sides[2];
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!Seen(recording, i, a) || !Seen(recording, i, b)) continue;
    sides[i < posture ? 0 : 1].push_back(
        (MarkerPosition(recording, i, a) - MarkerPosition(recording, i, b)).norm());
  }
  if (std::min(sides[0].size(), sides[1].size()) < Size(kFewestOnSide)) return std::nullopt;
  const double before = Median(sides[0]), after = Median(sides[1]);
  std::vector<double> off;
  for (const double d : sides[0]) off.push_back(std::abs(d - before));
  for (const double d : sides[1]) off.push_back(std::abs(d - after));
  return DistanceStep{
      std::abs(after - before), 1.4826 * Median(off),
      std::accumulate(off.begin(), off.end(), 0.0) / static_cast<double>(off.size())};
}

/// Displacement of a marker against the others of its cluster at a posture, m; nothing if it did
/// not move, or not alone.
std::optional<DistanceStep> MoveOf(const Recording& recording, const std::vector<int>& markers,
                                   int marker, int posture) {
  DistanceStep most;
  double spread = 0.0;
  std::vector<DistanceStep> own;
  for (const int other : markers) {
    if (other == marker) continue;
    const auto step = StepAt(recording, marker, other, posture);
    if (!step) continue;
    own.push_back(*step);
    spread += step->spread;
    if (step->size > most.size) most = *step;
  }
  const auto steps = [&](const DistanceStep& of) {
    return of.size > kLeastOfScatter * of.scatter && of.size > kLeastOfLargest * most.size;
  };
  if (most.size < kLeastStepOfMarker) return std::nullopt;
  if (static_cast<std::size_t>(std::count_if(own.begin(), own.end(), steps)) < kFewestSteps) {
    return std::nullopt;
  }
  for (std::size_t a = 0; a < markers.size(); ++a) {
    for (std::size_t b = a + 1; b < markers.size(); ++b) {
      if (markers[a] == marker || markers[b] == marker) continue;
      const auto step = StepAt(recording, markers[a], markers[b], posture);
      if (step && step->size > kOthersStay * most.size) return std::nullopt;
    }
  }
  return DistanceStep{most.size, most.scatter, spread};
}

}  // namespace

std::vector<Knock> FindMovedMarkers(const Recording& recording,
                                    const std::vector<LabelCluster>& clusters) {
  std::vector<Knock> moved;
  if (!recording.trials.empty()) return moved;
  const int last = recording.posture_count() - kFewestOnSide;
  const int stride = 1 + last / kSplitsOfTable;
  for (const LabelCluster& cluster : clusters) {
    std::optional<Knock> best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](int marker, int posture) {
      if (posture < kFewestOnSide || posture > last || !Seen(recording, posture, marker)) return;
      const auto step = MoveOf(recording, cluster.markers, marker, posture);
      if (!step || step->spread >= least) return;
      least = step->spread;
      best = Knock{cluster.name, {marker}, posture, posture - 1, step->size, 1.0};
    };
    for (const int marker : cluster.markers) {
      for (int posture = kFewestOnSide; posture <= last; posture += stride) {
        consider(marker, posture);
      }
    }
    if (!best) continue;
    const int marker = best->markers[0], around = best->posture;
    for (int off = 1; off < stride; ++off) {
      consider(marker, around - off);
      consider(marker, around + off);
    }
    while (!Seen(recording, best->last_before, marker)) --best->last_before;
    moved.push_back(*best);
  }
  return moved;
}

}  // namespace elastocal
