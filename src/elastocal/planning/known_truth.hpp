// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A robot with known errors, to show that a calibration finds them.
struct KnownTruth {
  ErrorModel model;
  Eigen::VectorXd delta;  ///< one an entry of model.parameters, SI
};

/// Errors of the size of the paper's Table 1 in all that no chain named `leg...` carries. The
/// cameras' frame is a few metres away, the markers a few millimetres from where they were meant to
/// be.
KnownTruth DrawUpperBodyErrors(const Project& project, std::uint64_t seed);

/// An estimated parameter of a joint beside its true value, SI.
struct FoundParameter {
  Parameter parameter;
  double truth = 0.0, estimate = 0.0, sd = 0.0;
  bool inside = false;  ///< the truth lies within the 95 % interval
};

/// All estimated parameters of joints, in the order of the result.
std::vector<FoundParameter> CompareWithTruth(const KnownTruth& truth,
                                             const CalibrationResult& result);

}  // namespace elastocal
