// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/simulation/matched_experiment.hpp"

namespace elastocal {

/// Contents of truth.yaml (docs/formats.md "Truth of a simulation"): the truth about the robot and
/// the sensors of each trial. `trials` are the indices of the trials that were played, and
/// `sensors` what was drawn for each of them.
std::string FormatTruth(const VirtualExperiment& experiment, const std::vector<std::size_t>& trials,
                        const std::vector<SensorTruth>& sensors);

/// As FormatTruth, for an experiment whose truth is the error model: its nonzero parameters by
/// name, with value and unit (SI).
std::string FormatMatchedTruth(const MatchedExperiment& experiment,
                               const std::vector<std::size_t>& trials,
                               const std::vector<SensorTruth>& sensors);

}  // namespace elastocal
