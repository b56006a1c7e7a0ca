// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/calibration/sole_changes.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/validation/calibration_comparison.hpp"

namespace elastocal {

/// Two stored calibrations and their differences.
struct ComparisonRun {
  CalibrationEstimate a, b;  ///< the earlier and the later one
  CalibrationComparison comparison;
  /// Differences of the soles, which belong to no joint and do not enter the verdict on joints.
  std::vector<SoleDifference> soles;
};

/// Reads two calibrations of one robot and finds the joints that moved between them (paper, section
/// 6.1.3). Each is given as the folder that calibrate wrote to, or as its calibration.yaml.
///
/// Throws InputError as FindCalibrationFiles, ReadCalibrationFiles and the comparison of estimates:
/// for other nominal robots, or nothing in common.
ComparisonRun CompareCalibrations(const std::filesystem::path& a, const std::filesystem::path& b,
                                  const ComparisonOptions& options = {});

}  // namespace elastocal
