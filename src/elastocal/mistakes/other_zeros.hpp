// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/offsets_fit.hpp"

namespace elastocal {

/// The table with the positions of one of the joints that turn by a half or a quarter of a turn
/// less, for each of `joints`: an encoder or a convention with another zero.
std::vector<LogAlternative> OtherZeros(const Recording& recording, const RobotTree& tree,
                                       const std::vector<int>& joints);

/// What a table has wrong whose markers are explained by joint offsets (`fit`) that no robot has:
/// a joint with another zero, or the sign of a joint or of its neighbours, which half a turn of the
/// joint before explains as well. Of several, the one with which the markers are where the project
/// has them. Each is undone, until offsets of robots explain the table as well as before; empty
/// where they do so without any, and where nothing achieves it. `fit` becomes that of the table
/// without these mistakes.
std::vector<LogAlternative> FindTurnedZeros(const Project& project, const ErrorModel& model,
                                            const Recording& recording, OffsetsFit& fit);

}  // namespace elastocal
