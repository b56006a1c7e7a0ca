// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/frame_precision.hpp"

namespace elastocal {

/// Errors of a model with their covariance.
struct KnownGeometry {
  const ErrorModel& model;
  const Eigen::VectorXd& delta;
  const std::vector<int>& parameters;  ///< indices into the model's
  const Eigen::MatrixXd& covariance;   ///< their covariance, in products of their SI units
};

/// As AssessFrames, but seen from the link `from` (0: the root link), over `postures` (one a row).
/// Empty where the recording says nothing of `from`.
std::vector<FramePrecision> AssessFramesFrom(int from, const KnownGeometry& known,
                                             const Eigen::MatrixXd& postures,
                                             const std::vector<int>& ends);

}  // namespace elastocal
