// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/label_check.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// Mistakes that a posture table seems to have; of each kind, the one that explains most first.
struct TableSuspicions {
  std::vector<LogSuspicion> log;
  std::vector<LabelSuspicion> labels;
};

/// Mistakes in a posture table that are far larger than errors of a robot. A table has no trials
/// whose waist the markers would show posture by posture, and may have a single marker. So each
/// mistake is tried on the whole table: the sign of a joint, two joints exchanged, labels of two
/// markers or two clusters exchanged. It is a suspicion where, once it is undone, one place of the
/// root link (of a free root, one in each posture) brings the nominal robot's markers far nearer to
/// the measured ones: from 20 mm or more, by the median, to less than 0.6 of it. Beside these:
/// - a joint that stays where it was for three postures or more, while others move, which are far
///   off with the root link where the other postures have it, is frozen;
/// - two markers of a cluster whose distances to the others of the cluster are each other's usual
///   ones in a tenth to half of the postures are exchanged there (fewer are outliers).
/// A suspicion is no proof: whether the recording fits once it is undone, a fit has to say.
/// `clusters` refer to the markers of the recording. Empty for a recording of trials.
TableSuspicions FindTableSuspicions(const ErrorModel& model, const Recording& recording,
                                    const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
