// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// A calibration on one screen: the verdict, all models side by side, the ten parameters furthest
/// from nominal, and what looks wrong. `verbose` adds the text of DescribeDetails.
std::string DescribeRun(const CalibrationRun& run, bool verbose);

}  // namespace elastocal::cli
