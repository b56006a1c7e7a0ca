// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "elastocal/calibration/sole_changes.hpp"
#include "elastocal/validation/calibration_comparison.hpp"

namespace elastocal::cli {

/// A comparison as text: the conclusion, joints and parameters by significance (the first ten and
/// those that moved; `verbose`: all), and what could not be compared. In degrees and mm.
std::string DescribeComparison(const CalibrationEstimate& a, const CalibrationEstimate& b,
                               const CalibrationComparison& comparison,
                               const ComparisonOptions& options, bool verbose);

/// The comparison as JSON, SI (docs/formats.md).
nlohmann::ordered_json MakeComparisonJson(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const CalibrationComparison& comparison,
                                          const ComparisonOptions& options);

/// Table of the differences of soles; empty without any.
std::string DescribeSoleChanges(const std::vector<SoleDifference>& soles);

/// These differences as JSON: `soles` of the comparison.
nlohmann::ordered_json SoleDifferencesJson(const std::vector<SoleDifference>& soles);

}  // namespace elastocal::cli
