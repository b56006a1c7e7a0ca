// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Finds mistakes in a posture table or its project that the nominal robot shows before anything is
/// estimated. Returns sentences with the correction; empty where there are none, for trials, and
/// for fewer than eight postures.
///
/// Each candidate is corrected. It is a mistake if less than 0.7 of PlacedMisfit is left, and if
/// the error of a robot whose joint offsets are estimated falls to less than a half and below 20
/// mm. (If these offsets are impossible for a robot, they explain much by themselves: then less
/// than a half of PlacedMisfit must be left, and no larger error.) The following are tried, in this
/// order:
///
/// - a frame of the markers that lies elsewhere from some posture on (FindMovedFrame);
/// - offsets that no robot has (FindTurnedZeros);
/// - the sign of each joint or motor, labels exchanged, rows shifted (RecordingMistake), or another
///   zero of a joint (OtherZeros);
/// - two joints or motors exchanged;
/// - couplings and mimic joints with the opposite sign or without effect (OtherFollowers);
/// - all signs of a limb, or the columns of two limbs (WholeLimbs);
/// - a joint's column that is the same in all rows, which the markers contradict;
/// - a root link that stands elsewhere in each posture, for which all geometric errors are
///   estimated.
std::vector<std::string> FindPlainMistakes(const Project& project, const Recording& recording);

}  // namespace elastocal
