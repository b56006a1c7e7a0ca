// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// An estimated offset of a joint that no assembly of a robot explains.
struct TurnedZero {
  int coordinate = 0;
  double offset = 0.0;  ///< rad
};

/// What a posture table says once the offsets of the joints and the places of the markers are
/// estimated, and nothing else of the robot.
struct OffsetsFit {
  double error = std::numeric_limits<double>::infinity();  ///< rms distance of the markers, m
  bool robot = false;              ///< whether some robot may have the offsets
  std::vector<TurnedZero> turned;  ///< offsets above an eighth of a turn
  double off_project = 0.0;        ///< mean distance of a marker from where the project has it, m
};

/// Estimates them. The error stays infinite where nothing can be estimated.
OffsetsFit FitOffsets(const Project& project, const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
