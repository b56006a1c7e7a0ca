// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/offsets_fit.hpp"

namespace elastocal {

/// For each of `joints` that is revolute: the table with its positions displaced by a half or a
/// quarter of a turn, as by an encoder or a convention with another zero.
std::vector<LogAlternative> OtherZeros(const Recording& recording, const RobotTree& tree,
                                       const std::vector<int>& joints);

/// Finds the mistakes of a table whose markers are explained by joint offsets (`fit`) that no robot
/// has: a joint with another zero, or the reversed sign of a joint or of its neighbours (half a
/// turn of the joint before explains the same). If several explain it, the one that leaves the
/// markers nearest to their positions in the project is taken. Mistakes are corrected until
/// possible offsets explain the table as well as before. Empty where possible offsets do so without
/// any correction, and where no correction achieves it. `fit` becomes the fit of the corrected
/// table.
std::vector<LogAlternative> FindTurnedZeros(const Project& project, const ErrorModel& model,
                                            const Recording& recording, OffsetsFit& fit);

}  // namespace elastocal
