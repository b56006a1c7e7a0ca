// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/planning/simulate_experiment.hpp"

namespace elastocal::cli {

/// Tables of the trials and of the legs' stiffness.
std::string DescribeSimulation(const SimulationRun& run);

/// The line that names the folder of the recording.
std::string WrittenRecording(const std::string& folder);

}  // namespace elastocal::cli
