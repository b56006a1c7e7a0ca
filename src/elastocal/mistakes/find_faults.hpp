// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/mistakes/fault_or_causes.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Whether reference lengths confirm the scale of every trial.
bool ScaleIsKnown(const std::vector<TrialSummary>& trials);

/// Finds faults of a recording as a whole, as sentences: a wrong up axis, mistakes that a second
/// fit proves (FindRecordingMistakes) and, where there are none of these, the fault that explains
/// most of the residuals (FindRecordingFaults). `as_recorded` is the recording before markers were
/// split at knocks, `recording` the fitted one. `springs_by_data`: the data chose which
/// joints give way, and a fault may hide in that; `choose` lets them choose anew.
std::vector<std::string> FindFaults(const Project& project, std::optional<std::uint64_t> seed,
                                    const Measurements& as_recorded, const RecordedModel& robot,
                                    const Recording& recording, const ModelComparison& comparison,
                                    bool springs_by_data = false, const ChoiceByData& choose = {});

}  // namespace elastocal
