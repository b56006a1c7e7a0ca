// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A robot with known errors, for tests of a calibration.
struct KnownTruth {
  ErrorModel model;
  Eigen::VectorXd delta;  ///< errors, one an entry of model.parameters, SI
};

/// Draws errors of the size of the paper's Table 1 for all that no chain named `leg...` carries.
/// The cameras' frame is a few metres away; the markers are a few millimetres from their nominal
/// positions.
KnownTruth DrawUpperBodyErrors(const Project& project, std::uint64_t seed);

/// An estimated parameter of a joint with its true value, SI.
struct FoundParameter {
  Parameter parameter;
  double truth = 0.0, estimate = 0.0, sd = 0.0;
  bool inside = false;  ///< the truth lies within the 95 % interval
};

/// All estimated parameters of joints, in the order of the result.
std::vector<FoundParameter> CompareWithTruth(const KnownTruth& truth,
                                             const CalibrationResult& result);

}  // namespace elastocal
