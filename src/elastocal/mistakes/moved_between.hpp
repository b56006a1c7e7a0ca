// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A cluster that may be elsewhere on its link in some trials.
struct MovedSuspect {
  LabelCluster cluster;
  std::vector<char> there;  ///< by posture: whether it is one of these trials
};

/// The suspect that is elsewhere on its link in its trials, in words; empty where none is. Each is
/// taken as two clusters, and the robot fitted again (at most the first three): it is elsewhere if
/// less than half of the error of `together` is left, and if it is by 1 mm and more. Where one
/// marker is displaced by three times any other one of its cluster, it is that marker, which may
/// have the label of another one. `all`: recording of `together`; `fit`: how that came about, if
/// not by Calibrate.
std::string FindMovedBetween(const Project& project, const CalibrationResult& together,
                             const Recording& all, const CalibrationOptions& options,
                             const std::vector<MovedSuspect>& suspects, const FitOf& fit = {});

}  // namespace elastocal
