// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// A cluster that is loose: its position on its link differs from posture to posture.
struct LooseCluster {
  /// Name of the cluster; empty: all clusters but those on the root link move together.
  std::string name;
  double off = 0.0;  ///< rms displacement of its markers from their predictions, m
  /// Share of their squared displacements that is left after one rigid motion in each posture.
  double left = 1.0;
  /// Rms displacement of the markers of the cluster that fits second worst, m.
  double others = 0.0;
};

/// Finds a loose cluster by the residuals of the fit `result`. It is the cluster with the largest
/// rms displacement, if this exceeds 0.5 mm and three times that of any other cluster, and if a
/// rigid motion of the cluster in each posture explains at least half of the squares. If there is
/// none, all clusters but those on the root link count together: if the rms of their mean
/// displacements exceeds 0.5 mm, and the displacement that they share in each posture explains at
/// least three quarters of the squares of each, then the root link swings, or its markers do.
/// Nothing for fewer than three clusters or eight postures. Call FindScatteredPositions first,
/// because a joint whose positions scatter looks alike.
std::optional<LooseCluster> FindLooseCluster(const CalibrationResult& result,
                                             const Recording& recording,
                                             const std::vector<LabelCluster>& clusters,
                                             const CalibrationOptions& options);

/// Whether the displacement is larger than that of any robot that is worth calibrating: more than 2
/// mm and, for a cluster, more than ten times that of any other (on a real robot, the hand may be
/// displaced more than the trunk).
bool IsTooLoose(const LooseCluster& loose);

/// Text such as "cluster FOREARM: its markers are elsewhere on their link in each posture (1.3 mm
/// rms), ...".
std::string Describe(const LooseCluster& loose);

}  // namespace elastocal
