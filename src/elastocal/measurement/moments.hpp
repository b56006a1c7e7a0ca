// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// For each posture, the number (from 0) of the motion of which it is a moment; -1 if it is a rest.
/// Two successive postures with rising times are moments of one motion if they are in one trial of
/// motion (Trial::of_motion) or, in a posture table, less than 0.5 s apart. Residuals of successive
/// moments of a motion are nearly equal. Without times, no posture is a moment.
std::vector<int> MotionOfPostures(const Recording& recording);

/// Whether any posture is a moment of a motion.
bool HasMotion(const Recording& recording);

/// Indices of the postures of a trial, ascending; all postures of a posture table, which has no
/// trials.
std::vector<int> PosturesOfTrial(const Recording& recording, int trial);

}  // namespace elastocal
