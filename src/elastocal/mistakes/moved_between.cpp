// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/moved_between.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/trial_names.hpp"
#include "elastocal/mistakes/estimated_place.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/screening/split_markers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostSuspects = 3;
constexpr double kLeftWhereMoved = 0.5;   // ratio to the error with the cluster in one place
constexpr double kLeastMoved = 1e-3;      // m
constexpr double kOneAlone = 3.0;         // ratio to any other marker of the cluster
constexpr double kLabelDistance = 20e-3;  // m: displacement of one marker, beyond what glue allows

/// Whether a marker is seen in any of these postures, or (`other`) in any of the others.
bool IsSeen(const Recording& recording, int marker, const std::vector<char>& postures, bool other) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    if ((postures[Size(i)] == 0) == other && Seen(recording, i, marker)) return true;
  }
  return false;
}

/// Result of splitting a suspect into two clusters.
struct Moved {
  std::vector<std::string> names;  ///< names of its markers
  std::vector<double> distances;   ///< distance between the two positions of each, m
  double left = 0.0;               ///< rms distance of all markers from the fit, m
};

Moved TakeAsTwo(const Project& project, const CalibrationResult& together, const Recording& all,
                const CalibrationOptions& options, const MovedSuspect& suspect,
                const FitOf& fit_of) {
  ErrorModel model = together.model;
  Recording split = all;
  std::vector<int> markers = suspect.cluster.markers;
  std::erase_if(markers, [&](int m) {
    return !IsSeen(all, m, suspect.there, false) || !IsSeen(all, m, suspect.there, true);
  });
  Moved moved;
  if (markers.empty()) {
    moved.left = std::numeric_limits<double>::infinity();
    return moved;
  }
  const int own = split.marker_count();
  std::vector<std::string> names_there;
  for (const int m : markers) {
    moved.names.push_back(all.marker_names[Size(m)]);
    names_there.push_back(moved.names.back() + "(moved)");
  }
  SplitMarkersOf(markers, names_there, suspect.there, model, split);
  const BaseParameters base = FindBaseOf(project, model, split);
  const CalibrationResult fit =
      fit_of ? fit_of(model, base, split) : Calibrate(model, split, base, together.kind, options);
  moved.left = MarkerError(fit, split, options);
  for (std::size_t k = 0; k < markers.size(); ++k) {
    moved.distances.push_back(
        (EstimatedPlace(fit, own + static_cast<int>(k)) - EstimatedPlace(fit, markers[k])).norm());
  }
  return moved;
}

std::string TrialsOf(const Recording& all, const MovedSuspect& suspect) {
  const std::vector<int>& markers = suspect.cluster.markers;
  return TrialNames(all, TrialsWith(all, [&](int i) {
                      return suspect.there[Size(i)] != 0 &&
                             std::any_of(markers.begin(), markers.end(),
                                         [&](int m) { return Seen(all, i, m); });
                    }));
}

std::string DescribeMoved(const Recording& all, const MovedSuspect& suspect, const Moved& moved,
                          double before) {
  const auto largest = std::max_element(moved.distances.begin(), moved.distances.end());
  double others = 0.0;
  for (auto it = moved.distances.begin(); it != moved.distances.end(); ++it) {
    if (it != largest) others = std::max(others, *it);
  }
  const bool alone = moved.distances.size() > 1 && *largest > kOneAlone * others;
  const std::string trials = TrialsOf(all, suspect);
  const std::string what =
      alone ? fmt::format(
                  "marker {} seems to be elsewhere on its link in trial {} than in the "
                  "others that show it, by {:.3g} mm ({})",
                  moved.names[Size(largest - moved.distances.begin())], trials, 1e3 * *largest,
                  *largest > kLabelDistance
                      ? "does it have the label of another marker in some of them?"
                      : "glued on again?")
            : fmt::format(
                  "cluster {}: its markers seem to be elsewhere on their link in trial {} "
                  "than in the others that show it, by {:.3g} mm (knocked, or glued on again, "
                  "between "
                  "them?)",
                  suspect.cluster.name, trials, 1e3 * *largest);
  return fmt::format(
      "{}; with places of their own for these trials, the error of the fit to all trials falls "
      "from {:.3g} to {:.3g} mm",
      what, 1e3 * before, 1e3 * moved.left);
}

}  // namespace

std::string FindMovedBetween(const Project& project, const CalibrationResult& together,
                             const Recording& all, const CalibrationOptions& options,
                             const std::vector<MovedSuspect>& suspects, const FitOf& fit) {
  const double before = MarkerError(together, all, options);
  double least = kLeftWhereMoved * before;
  std::string found;
  for (std::size_t k = 0; k < std::min(kMostSuspects, suspects.size()); ++k) {
    const Moved moved = TakeAsTwo(project, together, all, options, suspects[k], fit);
    if (!(moved.left < least) ||
        *std::max_element(moved.distances.begin(), moved.distances.end()) < kLeastMoved) {
      continue;
    }
    least = moved.left;
    found = DescribeMoved(all, suspects[k], moved, before);
  }
  return found;
}

}  // namespace elastocal
