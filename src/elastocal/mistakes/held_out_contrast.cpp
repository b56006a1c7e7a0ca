// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/held_out_contrast.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

std::vector<std::string> ChainsOf(const std::string& group) {
  std::vector<std::string> chains;
  std::istringstream text(group);
  for (std::string chain; std::getline(text, chain, '+');) chains.push_back(chain);
  return chains;
}

/// Number of the chains of a group (TrialGroups) that are also in another one.
std::ptrdiff_t CountShared(const std::string& group, const std::string& other) {
  const std::vector<std::string> others = ChainsOf(other);
  return std::ranges::count_if(ChainsOf(group), [&](const std::string& chain) {
    return std::ranges::find(others, chain) != others.end();
  });
}

/// RMSE over all observations of the groups whose names fulfil `which`; 0 where there are none.
template <typename Which>
double RmseOver(const ErrorTable& table, ModelKind kind, Which which) {
  double squares = 0.0;
  double count = 0.0;
  for (const ErrorTableRow& row : table.groups) {
    const auto metrics = row.metrics.find(kind);
    if (metrics == row.metrics.end() || metrics->second.observations == 0 || !which(row.group)) {
      continue;
    }
    squares += metrics->second.observations * std::pow(metrics->second.rmse_3d, 2);
    count += metrics->second.observations;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

/// RMSE of the groups within `group`: limbs that a held-out trial moves together may have been
/// measured one after the other. Where none is within it, that of the groups that share a chain
/// with it: limbs that were measured together may be held out alone.
double RmseLike(const ErrorTable& table, const std::string& group, ModelKind kind) {
  const double within = RmseOver(table, kind, [&](const std::string& other) {
    return CountShared(other, group) == std::ssize(ChainsOf(other));
  });
  if (within > 0.0) return within;
  return RmseOver(table, kind,
                  [&](const std::string& other) { return CountShared(other, group) > 0; });
}

Contrast LargestOfGroups(const ErrorTable& fitted, const ErrorTable& held_out, ModelKind kind) {
  Contrast largest{"", 1.0, 0.0, 0.0};
  for (const ErrorTableRow& row : held_out.groups) {
    const auto metrics = row.metrics.find(kind);
    const Contrast contrast{row.group, RmseLike(fitted, row.group, kind),
                            RmseLike(fitted, row.group, ModelKind::kUncalibrated),
                            metrics == row.metrics.end() ? 0.0 : metrics->second.rmse_3d};
    if (contrast.fitted > 0.0 && contrast.ratio() > largest.ratio()) largest = contrast;
  }
  return largest;
}

/// Root mean square error of the markers over the trials that show them; 0 where none does.
double RmseOfMarkers(const ErrorTable& table, const std::vector<int>& markers, ModelKind kind) {
  double squares = 0.0;
  double count = 0.0;
  for (const TrialErrors& trial : table.trials) {
    const auto metrics = trial.metrics.find(kind);
    if (metrics == trial.metrics.end()) continue;
    for (std::size_t k = 0; k < trial.markers.size(); ++k) {
      const double rmse = metrics->second.marker_rmse_3d[static_cast<Eigen::Index>(k)];
      const bool of_these =
          std::find(markers.begin(), markers.end(), trial.markers[k]) != markers.end();
      if (!of_these || !std::isfinite(rmse)) continue;
      squares += rmse * rmse;
      ++count;
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

Contrast LargestOfClusters(const ErrorTable& fitted, const ErrorTable& held_out,
                           const std::vector<LabelCluster>& clusters, ModelKind kind) {
  Contrast largest{"", 1.0, 0.0, 0.0};
  for (const LabelCluster& cluster : clusters) {
    const Contrast contrast{cluster.name, RmseOfMarkers(fitted, cluster.markers, kind),
                            RmseOfMarkers(fitted, cluster.markers, ModelKind::kUncalibrated),
                            RmseOfMarkers(held_out, cluster.markers, kind)};
    if (contrast.fitted > 0.0 && contrast.ratio() > largest.ratio()) largest = contrast;
  }
  return largest;
}

}  // namespace

double Contrast::ratio() const { return held_out / std::max(fitted, kBestExpected * uncalibrated); }

double Contrasts::largest() const { return std::max(of_groups.ratio(), of_clusters.ratio()); }

bool Contrasts::suspicious() const { return largest() > kSuspicious; }

Contrasts LargestContrasts(const ErrorTable& fitted, const ErrorTable& held_out,
                           const std::vector<LabelCluster>& clusters, ModelKind kind) {
  return {LargestOfGroups(fitted, held_out, kind),
          LargestOfClusters(fitted, held_out, clusters, kind)};
}

std::vector<MovedSuspect> MovedSuspects(const std::vector<LabelCluster>& clusters,
                                        const ErrorTable& fitted, const ErrorTable& held_out,
                                        ModelKind kind, const Recording& all) {
  std::vector<std::pair<double, MovedSuspect>> suspects;
  for (const LabelCluster& cluster : clusters) {
    const double known =
        std::max(RmseOfMarkers(fitted, cluster.markers, kind),
                 kBestExpected * RmseOfMarkers(fitted, cluster.markers, ModelKind::kUncalibrated));
    if (!(known > 0.0)) continue;
    double worst = 0.0;
    MovedSuspect suspect{cluster, std::vector<char>(Size(all.posture_count()), 0)};
    for (const TrialErrors& trial : held_out.trials) {
      ErrorTable alone;
      alone.trials = {trial};
      const double ratio = RmseOfMarkers(alone, cluster.markers, kind) / known;
      if (!(ratio > kSuspicious)) continue;
      worst = std::max(worst, ratio);
      for (int i = 0; i < all.posture_count(); ++i) {
        if (all.trials[Size(all.trial[Size(i)])].name == trial.trial) suspect.there[Size(i)] = 1;
      }
    }
    if (worst > 0.0) suspects.emplace_back(worst, suspect);
  }
  std::stable_sort(suspects.begin(), suspects.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<MovedSuspect> sorted;
  for (const auto& [ratio, suspect] : suspects) sorted.push_back(suspect);
  return sorted;
}

bool MayBeInertia(const RecordingFault& fault, const Recording& recording) {
  constexpr double kMostByInertia = 0.02;
  return fault.kind == FaultKind::kJointGain && fault.trial >= 0 &&
         recording.trials[Size(fault.trial)].of_motion() && std::abs(fault.size) < kMostByInertia;
}

}  // namespace elastocal
