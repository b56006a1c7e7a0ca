// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Sum of squared distances of the markers from their predictions, by posture, m^2. The robot
/// stands as in the estimate.
Eigen::VectorXd SquaresByPosture(const CalibrationResult& result, const Recording& recording,
                                 const CalibrationOptions& options);

/// Sums of squared distances with a joint moved by -1, 0 and 1 steps from its recorded position. A
/// step of Newton's method leads to the minimum.
struct DistanceParabola {
  Eigen::VectorXd before, at, after;

  Eigen::ArrayXd Curvature() const { return (before + after - 2.0 * at).array(); }
  /// Number of steps to the minimum; 0 where the curvature is at most `least`, so that the minimum
  /// is unknown.
  Eigen::ArrayXd ToLeast(double least) const;
};

/// The parabola of each posture, for a coordinate and a step of it, rad or m. `squares` are the
/// sums at 0 steps.
DistanceParabola ParabolaOf(const CalibrationResult& result, const Recording& recording,
                            int coordinate, double step, const Eigen::VectorXd& squares,
                            const CalibrationOptions& options);

}  // namespace elastocal
