// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// covariance.csv: covariance of the estimated and unsupported parameters together, rad and m, with
/// their names as header row and first column.
std::string MakeCovarianceCsv(const CalibrationResult& result);
/// The same file for any covariance; `names` are those of its rows and columns.
std::string MakeCovarianceCsv(const std::vector<std::string>& names,
                              const Eigen::MatrixXd& covariance);

/// Reads the covariance.csv that belongs to a calibration into it. Throws InputError naming file
/// and line: names that the calibration does not have or that differ between header and rows,
/// variances that are not those of the calibration (so the file belongs to another one), a matrix
/// that is not symmetric, estimated parameters that it lacks.
void ReadCovariance(const std::filesystem::path& file, CalibrationEstimate& estimate);

/// The same from a stream; `source` names it in messages.
void ReadCovariance(std::istream& stream, const std::string& source, CalibrationEstimate& estimate);

}  // namespace elastocal
