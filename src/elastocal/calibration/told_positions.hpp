// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A posture table with the positions of one joint as its markers tell them, whatever the column
/// says: in each posture the one within the joint's limits (at most half a turn or 1 m to either
/// side of 0) that brings the nominal markers nearest to the measured ones, with one place of the
/// root link for all postures. Place and positions are found in turn. `coordinate`: entry of q that
/// drives one joint.
Recording WithToldPositions(const ErrorModel& model, const Recording& recording, int coordinate);

}  // namespace elastocal
