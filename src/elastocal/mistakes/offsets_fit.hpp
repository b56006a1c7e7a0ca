// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// An estimated joint offset that no assembly of a robot explains.
struct TurnedZero {
  int coordinate = 0;
  double offset = 0.0;  ///< rad
};

/// Fit of a posture table in which only joint offsets and marker positions are estimated.
struct OffsetsFit {
  double error = std::numeric_limits<double>::infinity();  ///< rms distance of the markers, m
  bool robot = false;                                      ///< the offsets are possible for a robot
  std::vector<TurnedZero> turned;  ///< offsets of more than an eighth of a turn
  /// Mean distance of the markers from their positions in the project, m.
  double off_project = 0.0;
};

/// Makes the fit. The error stays infinite where nothing can be estimated.
OffsetsFit FitOffsets(const Project& project, const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
