// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Whether reference lengths say of every trial that its scale is right.
bool ScaleIsKnown(const std::vector<TrialSummary>& trials);

/// What is wrong with a recording as a whole, in words: a wrong axis up, mistakes that a second fit
/// proves (FindRecordingMistakes) and, where there are none of these, the fault that explains most
/// of what the fit leaves (FindRecordingFaults). `as_recorded`: before markers were split at
/// knocks; `recording`: what was fitted.
std::vector<std::string> FindFaults(const Project& project, std::optional<std::uint64_t> seed,
                                    const Measurements& as_recorded, const RecordedModel& robot,
                                    const Recording& recording, const ModelComparison& comparison);

}  // namespace elastocal
