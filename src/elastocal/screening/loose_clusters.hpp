// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// Markers that are elsewhere in each posture.
struct LooseCluster {
  std::string name;     ///< empty: all but those of the root link
  double off = 0.0;     ///< rms displacement of its markers, m
  double left = 1.0;    ///< share of their squared distances that is left without
  double others = 0.0;  ///< rms distance of the markers of the cluster that fits worst beside it, m
};

/// The cluster, of what a fit leaves, whose markers are off by three times those of any other and
/// by half a millimetre, and move as one body: it is loose on its link. Else all clusters but those
/// of the root link, if a displacement that they share in each posture takes three quarters of the
/// squared distances of each of them: the root link swings, or its markers do. Joints' positions
/// that scatter are asked for first (FindScatteredPositions).
std::optional<LooseCluster> FindLooseCluster(const CalibrationResult& result,
                                             const Recording& recording,
                                             const std::vector<LabelCluster>& clusters,
                                             const CalibrationOptions& options);

/// Whether nothing that is worth calibrating does so: 2 mm, and of a cluster ten times those of any
/// other (a hand of a real robot may be off by more than its trunk).
bool IsTooLoose(const LooseCluster& loose);

/// "cluster FOREARM: its markers are elsewhere on their link in each posture (1.3 mm rms), ...".
std::string Describe(const LooseCluster& loose);

}  // namespace elastocal
