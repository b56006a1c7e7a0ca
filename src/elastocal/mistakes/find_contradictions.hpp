// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Two markers of a cluster whose labels a tracker exchanged for a while, in no more than half of
/// the held-out postures that show them: the estimate knows nothing of it, and where the distances
/// of the cluster are alike only the robot tells. Takes the two out of `held_out` there, and
/// in two postures on either side, which the filter mixes, and says so; empty where there is
/// nothing of the kind.
std::string LeaveOutBriefExchange(const Project& project, const Recording& recording,
                                  const ModelComparison& comparison,
                                  const ErrorTable& held_out_table, Recording& held_out);

/// Where held-out trials contradict those of the estimate. A fault in the only trial that exercises
/// a joint is one that this trial cannot show: it is fitted as an error of the robot. So where the
/// largest model errs on the held-out trials of a group of chains, or on a cluster in them, by more
/// than three times its error on what it used of the trials of the estimate, all trials are fitted
/// together and the fault that explains most of what is left is named; from ten times on the
/// contradiction itself is an objection. Clean recordings stay below three, so nothing more is
/// fitted for them.
std::vector<std::string> FindContradictions(const Project& project, const RecordedModel& robot,
                                            const Recording& recording, const Recording& held_out,
                                            const ModelComparison& comparison,
                                            const ErrorTable& held_out_table);

}  // namespace elastocal
