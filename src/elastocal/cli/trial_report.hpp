// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// Table of what was used of each trial in recording folders; empty for a posture table.
std::string DescribeTrials(const CalibrationRun& run);

/// Text on the stiffness of legs and joints with 95 % intervals, for the elastic model, on those
/// that the data do not determine, and the reason. Empty where nothing is elastic.
std::string DescribeElasticity(const CalibrationRun& run);

/// Text on feet that slipped and on support constraints that did not hold.
std::string DescribeFeet(const CalibrationRun& run);

/// Table 2 of the paper and the error of the waist, for trials for validation; empty without any.
std::string DescribeHeldOut(const CalibrationRun& run);

}  // namespace elastocal::cli
