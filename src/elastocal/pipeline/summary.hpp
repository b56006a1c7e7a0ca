// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal {

/// summary.json: the figures of a run, for programs to read (docs/formats.md).
std::string MakeSummaryJson(const CalibrationRun& run);

}  // namespace elastocal
