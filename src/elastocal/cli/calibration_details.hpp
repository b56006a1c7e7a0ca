// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// Parameters with estimate, standard deviation and 95 % interval, in mm and degrees.
std::string EstimateTable(const CalibrationResult& result, const std::vector<int>& which);

/// Markers that were estimated far (20 mm) from where the project has them: measured roughly, on
/// another link, or exchanged. "LHAND_1 31 mm" each.
std::vector<std::string> DisplacedMarkers(const CalibrationResult& result);

/// What is known of a calibration besides DescribeRun: trials, held-out motions, the course of the
/// fit, every parameter, elasticity, feet, parameters that stayed nominal by name, outliers,
/// excitation and strong correlations.
std::string DescribeDetails(const CalibrationRun& run);

}  // namespace elastocal::cli
