// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "elastocal/calibration/sole_changes.hpp"
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

/// A table of the springs of soles; empty without any.
std::string DescribeSoleChanges(const std::vector<SoleDifference>& soles);

/// The same for programs: `soles` of the comparison.
nlohmann::ordered_json SoleDifferencesJson(const std::vector<SoleDifference>& soles);

}  // namespace elastocal::cli
