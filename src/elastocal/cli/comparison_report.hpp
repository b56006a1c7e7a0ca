// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "elastocal/validation/calibration_comparison.hpp"

namespace elastocal::cli {

/// What a person should read of a comparison: the conclusion, joints and parameters by significance
/// (the first ten and what moved; `verbose`: all), what could not be compared. Degrees and mm.
std::string DescribeComparison(const CalibrationEstimate& a, const CalibrationEstimate& b,
                               const CalibrationComparison& comparison,
                               const ComparisonOptions& options, bool verbose);

/// The same for programs, SI (docs/formats.md).
nlohmann::ordered_json MakeComparisonJson(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const CalibrationComparison& comparison,
                                          const ComparisonOptions& options);

}  // namespace elastocal::cli
