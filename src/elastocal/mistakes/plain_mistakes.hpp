// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Mistakes in a posture table or its project that the nominal robot shows before anything is
/// estimated, in words with what corrects them; empty where it shows none, for trials, and for
/// fewer than eight postures. Each is undone, and is a mistake if less than 0.7 of PlacedMisfit is
/// left, and of the error of a robot whose joint offsets are estimated less than a half and 20 mm.
/// (Where those offsets are such as no robot has, they explain much by themselves: then less than a
/// half of PlacedMisfit, and of the error no more.) Tried are: offsets that no robot has
/// (FindTurnedZeros); the sign of each joint or motor, labels exchanged, rows shifted
/// (RecordingMistake), or another zero of a joint (OtherZeros); then two joints or motors
/// exchanged; then couplings and mimic joints of the opposite sign or that do not follow
/// (OtherFollowers); then all signs of a limb, or the columns of two limbs (WholeLimbs); then a
/// joint's column that is the same in all rows, which the markers contradict; then a root link that
/// stands elsewhere in each posture, for which all geometric errors are estimated. First of all, a
/// frame of the markers that lies elsewhere from some posture on (FindMovedFrame).
std::vector<std::string> FindPlainMistakes(const Project& project, const Recording& recording);

}  // namespace elastocal
