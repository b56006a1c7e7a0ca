// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A displacement of the markers' frame against the root link from some posture of a table on: a
/// tracker was pushed, or the robot's base.
struct MovedFrame {
  int posture = 0;                   ///< the first posture with it, from 0
  std::vector<std::string> markers;  ///< markers on the root link that show it
  double shift = 0.0;                ///< displacement of their centre, m
  double angle = 0.0;                ///< rad
  double displaced = 0.0;            ///< rms displacement of the other markers, m
};

/// Finds such a displacement in a posture table of a robot whose root link stands still. Three or
/// more markers on that link show it: they are in one place before a posture and in another from
/// there on, by ten times their scatter and as one rigid body. The other markers must be displaced
/// by more than 1.5 mm. Nothing for a recording of trials, where each posture has a pose of its
/// own.
std::optional<MovedFrame> FindMovedFrame(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
