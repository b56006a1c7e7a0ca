// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A posture table with the positions of one joint as its markers tell them, whatever the column
/// says: in each posture the one within the joint's limits (at most half a turn or 1 m to either
/// side of 0) that brings the nominal markers nearest to the measured ones, with one place of the
/// root link for all postures. Place and positions are found in turn. `coordinate`: entry of q that
/// drives one joint.
Recording WithToldPositions(const ErrorModel& model, const Recording& recording, int coordinate);

/// A posture table with half a turn more or less of one joint in some postures.
struct HalfTurns {
  std::vector<int> postures;
  Recording turned;
};

/// Postures in which the markers tell a joint half a turn from where its column has it, while they
/// confirm it in the others: its position was logged modulo half a turn. None where they are fewer
/// than three, where more than a fifth of the postures tell neither, where the column does not keep
/// within half a turn, or where the joint does.
HalfTurns FindHalfTurns(const ErrorModel& model, const Recording& recording, int coordinate);

}  // namespace elastocal
