// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/simulation/matched_experiment.hpp"

namespace elastocal {

/// truth.yaml (docs/formats.md "Truth of a simulation"): what is true of the robot and of each
/// trial's sensors. `trials` are those of the experiment that were played, and `sensors` what was
/// drawn for each of them.
std::string FormatTruth(const VirtualExperiment& experiment, const std::vector<std::size_t>& trials,
                        const std::vector<SensorTruth>& sensors);

/// The same of an experiment whose truth is the error model: the parameters of the model that are
/// not zero, by name, with value and unit (SI).
std::string FormatMatchedTruth(const MatchedExperiment& experiment,
                               const std::vector<std::size_t>& trials,
                               const std::vector<SensorTruth>& sensors);

}  // namespace elastocal
