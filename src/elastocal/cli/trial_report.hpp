// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// What was taken of each trial of recording folders; empty for a posture table.
std::string DescribeTrials(const CalibrationRun& run);

/// Stiffness of legs and joints with its 95 % interval, of the model with elasticity; which ones
/// the data do not determine, and why in words. Empty where nothing is elastic.
std::string DescribeElasticity(const CalibrationRun& run);

/// Feet that slipped and constraints that did not hold.
std::string DescribeFeet(const CalibrationRun& run);

/// Table 2 of the paper and the error of the waist, of trials for validation; empty without any.
std::string DescribeHeldOut(const CalibrationRun& run);

}  // namespace elastocal::cli
