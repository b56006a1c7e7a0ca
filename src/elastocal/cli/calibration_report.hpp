#pragma once

#include <string>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal::cli {

/// The models side by side, mm: one row a model.
std::string ModelTable(const CalibrationRun& run);

/// All that a person should read of a calibration: fit, parameters with their uncertainty, what was
/// not supported, outliers, excitation, correlations.
std::string DescribeRun(const CalibrationRun& run);

}  // namespace elastocal::cli
