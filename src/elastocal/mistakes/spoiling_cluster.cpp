// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/spoiling_cluster.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/screening/loose_clusters.hpp"

namespace elastocal {
namespace {

constexpr double kLeftWithoutLoose = 0.5;  // share of the error of all other markers

Recording WithoutMarkers(const LabelCluster& cluster, Recording recording) {
  for (const int m : cluster.markers) recording.markers.middleCols<3>(3 * m).setConstant(kNaN);
  return recording;
}

}  // namespace

std::vector<std::string> FindSpoilingCluster(const Project& project, const RecordedModel& robot,
                                             const Recording& recording,
                                             const CalibrationResult& result) {
  const std::vector<LabelCluster> clusters = SeenClusters(project, recording);
  const auto loose = FindLooseCluster(result, recording, clusters, project.calibration);
  if (!loose) return {};
  if (IsTooLoose(*loose)) return {Describe(*loose)};
  const auto cluster = std::ranges::find(clusters, loose->name, &LabelCluster::name);
  if (cluster == clusters.end()) return {};
  const Recording others = WithoutMarkers(*cluster, recording);
  const double with = MarkerError(result, others, project.calibration);
  const double without = ErrorAlone(robot, others, result.kind, project.calibration);
  if (!(without < kLeftWithoutLoose * with)) return {};
  return {fmt::format(
      "{} Without cluster {} the error of all other markers falls from {:.3g} to {:.3g} mm: fasten "
      "the cluster and measure again, or take its markers out of the project",
      Describe(*loose), loose->name, 1e3 * with, 1e3 * without)};
}

}  // namespace elastocal
