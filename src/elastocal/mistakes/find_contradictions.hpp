// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Finds two markers of a cluster whose labels a tracker exchanged for a while, in at most half of
/// the held-out postures that show them. The estimate cannot know this, and where the distances in
/// the cluster are similar only the robot shows it. Hides the two markers in `held_out` there and
/// in two postures on either side, which the filter mixes, and returns a sentence; empty where
/// there is no such exchange.
std::string LeaveOutBriefExchange(const Project& project, const Recording& recording,
                                  const ModelComparison& comparison,
                                  const ErrorTable& held_out_table, Recording& held_out);

/// Finds where held-out trials contradict those of the estimate. A fault in the only trial that
/// exercises a joint is invisible in that trial, because it is fitted as an error of the robot. If
/// the largest model's error on the held-out trials of a group of chains, or on a cluster in them,
/// exceeds three times its error on the data of the estimate, all trials are fitted together, and
/// the fault that explains most of the residuals is named. From a ratio of ten on, the
/// contradiction itself is an objection. Clean recordings stay below three, so that nothing is
/// fitted for them.
std::vector<std::string> FindContradictions(const Project& project, const RecordedModel& robot,
                                            const Recording& recording, const Recording& held_out,
                                            const ModelComparison& comparison,
                                            const ErrorTable& held_out_table);

/// Describes a wrong scale of the cameras that the lengths of the robot show in the trials of the
/// estimate (`recording`), given in words as one of all trials (`of_all`). Those trials alone do
/// not tell whether held-out ones have it, too. If one robot leaves less than half of its error in
/// all trials with one factor undone in the trials of the estimate, these are named instead, with
/// the factor.
std::string TellScaleOfTrials(const Project& project, const RecordedModel& robot,
                              const Recording& recording, const Recording& held_out, ModelKind kind,
                              const std::string& of_all);

}  // namespace elastocal
