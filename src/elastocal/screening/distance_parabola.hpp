// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Squared distances of the markers from an estimate, by posture, m^2. The robot stands where the
/// estimate has it.
Eigen::VectorXd SquaresByPosture(const CalibrationResult& result, const Recording& recording,
                                 const CalibrationOptions& options);

/// Sums of squared distances where a joint is at -1, 0 and 1 steps from where it was recorded: a
/// step of Newton's method leads to where they are least.
struct DistanceParabola {
  Eigen::VectorXd before, at, after;

  Eigen::ArrayXd Curvature() const { return (before + after - 2.0 * at).array(); }
  /// In steps, to where the squares are least; 0 where the curvature is no more than `least`, which
  /// shows nothing of where that is.
  Eigen::ArrayXd ToLeast(double least) const;
};

/// By posture, for a coordinate and a step of it, rad or m. `squares`: those at 0 steps.
DistanceParabola ParabolaOf(const CalibrationResult& result, const Recording& recording,
                            int coordinate, double step, const Eigen::VectorXd& squares,
                            const CalibrationOptions& options);

}  // namespace elastocal
