// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/screening/label_check.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// Mistakes that a posture table seems to contain; of each kind, the one that explains most first.
struct TableSuspicions {
  std::vector<LogSuspicion> log;
  std::vector<LabelSuspicion> labels;
};

/// Finds mistakes in a posture table that are far larger than errors of a robot. A table has no
/// trials in which the markers show the waist posture by posture, and may have a single marker.
/// Each mistake is therefore tried on the whole table: the reversed sign of a joint, two joints
/// exchanged, labels of two markers or two clusters exchanged. It is a suspicion if, with the
/// mistake corrected, one pose of the root link (for a free root one in each posture) brings the
/// nominal markers far nearer to the measured ones: from a median of 20 mm or more to less than 0.6
/// of it. In addition:
/// - a joint is frozen if it stays at one position for at least three postures while others move,
///   and these postures are far off with the root link placed by the other postures;
/// - two markers of a cluster are exchanged in a part of the postures (a tenth to half; fewer are
///   outliers) if their distances to the others of the cluster are each other's usual ones there.
///
/// A suspicion is no proof: a fit has to tell whether the corrected recording fits. `clusters`
/// refer to the markers of the recording. Empty for a recording of trials.
TableSuspicions FindTableSuspicions(const ErrorModel& model, const Recording& recording,
                                    const std::vector<LabelCluster>& clusters);

}  // namespace elastocal
