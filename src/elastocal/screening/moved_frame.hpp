// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// From a posture of a table on, the frame of the markers lies elsewhere against the root link: a
/// tracker was pushed, or the robot's base.
struct MovedFrame {
  int posture = 0;                   ///< the first one, from 0
  std::vector<std::string> markers;  ///< on the root link, which show it
  double shift = 0.0;                ///< m, of their middle
  double angle = 0.0;                ///< rad
  double displaced = 0.0;            ///< rms of the other markers, m
};

/// Looks for it in a posture table of a robot whose root link stands still, by three or more
/// markers on that link: they are in one place before a posture and in another from there on, by
/// ten times what they scatter beside that, as one rigid body, and the other markers are displaced
/// by more than 1.5 mm. Nothing of a recording of trials, where each posture has a place of its
/// own.
std::optional<MovedFrame> FindMovedFrame(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
