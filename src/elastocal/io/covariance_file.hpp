#pragma once

#include <filesystem>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// Reads the covariance.csv that belongs to a calibration into it. Throws InputError naming file
/// and line: names that the calibration does not have or that differ between header and rows,
/// variances that are not those of the calibration (so the file belongs to another one), a matrix
/// that is not symmetric, estimated parameters that it lacks.
void ReadCovariance(const std::filesystem::path& file, CalibrationEstimate& estimate);

}  // namespace elastocal
