// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Finds columns of a joint log that are in another order than the header says, in a recording of
/// trials: left and right limbs exchanged, columns shifted by one, sorted otherwise. In each trial
/// whose markers are far (50 mm) from the nominal robot, each joint gets the column nearest to its
/// positions by the markers (PositionsByMarkers), until nothing changes. An order is suspected if
/// with it joints that were off by at least 0.06 rad are off by less than half. Trials with the
/// same order form one suspicion. Exchanges of two columns are left to FindLogSuspicions. Also
/// finds columns that are identical copies of another one, although the markers show one of the two
/// joints to move differently; that joint is corrected to the positions that the markers show.
std::vector<TriedCorrection> FindColumnOrders(const ErrorModel& nominal,
                                              const Recording& recording);

}  // namespace elastocal
