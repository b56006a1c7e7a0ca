// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/spoiling_cluster.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/screening/loose_clusters.hpp"

namespace elastocal {
namespace {

constexpr double kLeftWithoutLoose = 0.5;  // of the error of all other markers

/// Error of all other markers by a fit and by one without the cluster, m.
std::pair<double, double> ErrorsBeside(const LabelCluster& cluster, const Project& project,
                                       const RecordedModel& robot, Recording recording,
                                       const CalibrationResult& result) {
  for (const int m : cluster.markers) recording.markers.middleCols<3>(3 * m).setConstant(kNaN);
  const double with = MarkerError(result, recording, project.calibration);
  try {
    return {with, FitError(Calibrate(robot.model, recording, robot.base, result.kind,
                                     project.calibration),
                           recording, project.calibration)};
  } catch (const InputError&) {  // too few markers are left
    return {with, with};
  }
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
  const auto [with, without] = ErrorsBeside(*cluster, project, robot, recording, result);
  if (!(without < kLeftWithoutLoose * with)) return {};
  return {fmt::format(
      "{} Without it the error of all others falls from {:.3g} to {:.3g} mm: fasten it and measure "
      "again, or take its markers out of the project",
      Describe(*loose), 1e3 * with, 1e3 * without)};
}

}  // namespace elastocal
