// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// The posture table with the positions of one joint as its markers show them, whatever the column
/// says. In each posture it is the position within the joint's limits (at most half a turn or 1 m
/// to either side of 0) that brings the nominal markers nearest to the measured ones, with one pose
/// of the root link for all postures. Pose and positions are found in turn. `coordinate` is an
/// entry of q that drives one joint.
Recording WithToldPositions(const ErrorModel& model, const Recording& recording, int coordinate);

/// A posture table in which one joint is corrected by half a turn in some postures.
struct HalfTurns {
  std::vector<int> postures;
  Recording turned;
};

/// Finds postures in which the markers show a joint half a turn from its column, while they confirm
/// the column in the others: its position was logged modulo half a turn. Empty where these are
/// fewer than three, where more than a fifth of the postures show neither, where the column spans
/// more than half a turn, or where the joint itself moves by less.
HalfTurns FindHalfTurns(const ErrorModel& model, const Recording& recording, int coordinate);

}  // namespace elastocal
