// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// Table of parameters with estimate, standard deviation and 95 % interval, in mm and degrees.
std::string EstimateTable(const CalibrationResult& result, const std::vector<int>& which);

/// Markers that were estimated far (20 mm) from their positions in the project: measured roughly,
/// on another link, or exchanged. An entry is like "LHAND_1 31 mm".
std::vector<std::string> DisplacedMarkers(const CalibrationResult& result);

/// What is known of a calibration beyond DescribeRun: trials, held-out motions, the course of the
/// fit, every parameter, elasticity, feet, names of parameters that stayed nominal, outliers,
/// excitation and strong correlations.
std::string DescribeDetails(const CalibrationRun& run);

}  // namespace elastocal::cli
