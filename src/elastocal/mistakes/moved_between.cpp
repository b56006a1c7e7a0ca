// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/moved_between.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostSuspects = 3;
constexpr double kLeftWhereMoved = 0.5;   // of the error with the cluster in one place
constexpr double kLeastMoved = 1e-3;      // m
constexpr double kOneAlone = 3.0;         // times any other marker of the cluster
constexpr double kLabelDistance = 20e-3;  // m: of one marker, which no glue lets slip so far

/// Where the fit has a marker, in the frame of its link.
Eigen::Vector3d PlaceOf(const CalibrationResult& result, int marker) {
  const int first = result.model.parameter_count() - 3 * result.model.marker_count();
  return result.model.markers[Size(marker)].p_link_marker +
         result.delta.segment<3>(first + 3 * marker);
}

/// Whether a marker is seen in any of these postures, or any other one.
bool IsSeen(const Recording& recording, int marker, const std::vector<char>& postures, bool other) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    if ((postures[Size(i)] == 0) == other && Seen(recording, i, marker)) return true;
  }
  return false;
}

/// A suspect that was taken as two clusters.
struct Moved {
  std::vector<std::string> names;  ///< of its markers
  std::vector<double> distances;   ///< of the two places of each, m
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
  // Those of the suspect's trials get markers of their own.
  const int own = split.marker_count();
  const auto count = static_cast<Eigen::Index>(markers.size());
  for (const int m : markers) {
    model.markers.push_back(together.model.markers[Size(m)]);
    model.markers.back().name += "(moved)";
    split.marker_names.push_back(model.markers.back().name);
    moved.names.push_back(all.marker_names[Size(m)]);
  }
  split.markers.conservativeResize(Eigen::NoChange, split.markers.cols() + 3 * count);
  split.markers.rightCols(3 * count).setConstant(kNaN);
  for (int i = 0; i < all.posture_count(); ++i) {
    if (suspect.there[Size(i)] == 0) continue;
    for (std::size_t k = 0; k < markers.size(); ++k) {
      auto from = split.markers.block<1, 3>(i, 3 * markers[k]);
      split.markers.block<1, 3>(i, 3 * (own + static_cast<int>(k))) = from;
      from.setConstant(kNaN);
    }
  }
  model = SelectMarkers(model, split.marker_names);
  const BaseParameters base = FindBaseParameters(model, project.identifiability);
  const CalibrationResult fit =
      fit_of ? fit_of(model, base, split) : Calibrate(model, split, base, together.kind, options);
  moved.left = MarkerError(fit, split, options);
  for (std::size_t k = 0; k < markers.size(); ++k) {
    moved.distances.push_back(
        (PlaceOf(fit, own + static_cast<int>(k)) - PlaceOf(fit, markers[k])).norm());
  }
  return moved;
}

std::string TrialsOf(const Recording& all, const MovedSuspect& suspect) {
  std::string names;
  for (int trial = 0; trial < static_cast<int>(all.trials.size()); ++trial) {
    bool shows = false;
    for (int i = 0; i < all.posture_count() && !shows; ++i) {
      shows = all.trial[Size(i)] == trial && suspect.there[Size(i)] != 0 &&
              std::any_of(suspect.cluster.markers.begin(), suspect.cluster.markers.end(),
                          [&](int m) { return Seen(all, i, m); });
    }
    if (shows) names += (names.empty() ? "" : ", ") + all.trials[Size(trial)].name;
  }
  return names;
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
