// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Columns of a joint log that are in another order than its header says, in a recording of trials:
/// left and right limbs exchanged, one column too far, sorted otherwise. In each trial whose
/// markers are far (50 mm) from the nominal robot, each joint gets the column that is nearest to
/// where the markers show it (PositionsByMarkers), until nothing changes. An order is suspected if
/// joints that were off by 0.06 rad and more are off by less than half with it; trials of the same
/// order are one suspicion. Exchanges of two columns are none: FindLogSuspicions has them. And
/// columns that are copies of each other, number for number, though the markers show one of the
/// joints to move otherwise: it is put where the markers show it.
std::vector<TriedCorrection> FindColumnOrders(const ErrorModel& nominal,
                                              const Recording& recording);

}  // namespace elastocal
