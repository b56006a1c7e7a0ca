// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// The motion that each posture is a moment of, numbered from 0; -1: of none. Two postures that
/// follow each other are moments of one motion in a trial whose samples are those of a motion, and
/// in a table of postures with times if less than half a second is between them. What the model
/// does not explain hardly changes from one to the other.
std::vector<int> MotionOfPostures(const Recording& recording);

/// Whether any posture is a moment of a motion.
bool HasMotion(const Recording& recording);

/// The postures of a trial, ascending; all of a table of postures, which has no trials.
std::vector<int> PosturesOfTrial(const Recording& recording, int trial);

}  // namespace elastocal
