// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/recording_warnings.hpp"

#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/coarse_positions.hpp"
#include "elastocal/screening/doubtful_gains.hpp"
#include "elastocal/screening/loose_clusters.hpp"
#include "elastocal/screening/turned_clusters.hpp"

namespace elastocal {

std::vector<std::string> RecordingWarnings(const Project& project, const CalibrationResult& fit,
                                           const Recording& recording,
                                           const std::vector<TrialSummary>& trials,
                                           const std::optional<CommonScale>& scale) {
  const CalibrationOptions& options = project.calibration;
  std::vector<std::string> warnings;
  const std::vector<LabelCluster> clusters = SeenClusters(project, recording);
  for (const TurnedCluster& one : FindTurnedClusters(fit, clusters)) {
    warnings.push_back(Describe(one));
  }
  for (const CoarsePositions& one : FindCoarsePositions(fit, recording, options, trials)) {
    warnings.push_back(Describe(one, project.tree));
  }
  if (const auto scattered = FindScatteredPositions(fit, recording, options)) {
    warnings.push_back(Describe(*scattered, project.tree));
  } else if (const auto cluster = FindLooseCluster(fit, recording, clusters, options)) {
    warnings.push_back(Describe(*cluster));
  }
  for (const RecordingFault& gain : FindDoubtfulGains(fit, recording, options)) {
    warnings.push_back(DescribeDoubtfulGain(gain, project.tree));
  }
  if (scale && IsDoubtful(*scale) && !ScaleIsKnown(trials)) {
    warnings.push_back(DescribeDoubt(*scale));
  }
  return warnings;
}

}  // namespace elastocal
