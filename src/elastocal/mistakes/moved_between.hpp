// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A cluster that may be displaced on its link in some trials.
struct MovedSuspect {
  LabelCluster cluster;
  std::vector<char> there;  ///< for each posture: whether it belongs to these trials
};

/// Describes the suspect that is displaced on its link in its trials; empty where none is. Each
/// suspect (at most the first three) is split into two clusters, and the robot is fitted again. It
/// is displaced if less than half of the error of `together` is left, and if the displacement is at
/// least 1 mm. If one marker is displaced by three times as much as any other of its cluster, that
/// marker is named, which may have the label of another one. `all` is the recording of `together`;
/// `fit` is the function that made it, if not Calibrate.
std::string FindMovedBetween(const Project& project, const CalibrationResult& together,
                             const Recording& all, const CalibrationOptions& options,
                             const std::vector<MovedSuspect>& suspects, const FitOf& fit = {});

}  // namespace elastocal
