// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/calibration/sole_changes.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/validation/calibration_comparison.hpp"

namespace elastocal {

/// Two stored calibrations and what differs between them.
struct ComparisonRun {
  CalibrationEstimate a, b;  ///< the earlier and the later one
  CalibrationComparison comparison;
  std::vector<SoleDifference> soles;  ///< which no joint has, and no verdict of the joints
};

/// Reads two calibrations of one robot and tells which joints moved between them (paper, section
/// 6.1.3). Each is given as the folder that calibrate wrote to, or as its calibration.yaml.
///
/// Throws InputError: what FindCalibrationFiles and ReadCalibrationFiles refuse, and what the
/// comparison of estimates refuses: other nominal robots, nothing in common.
ComparisonRun CompareCalibrations(const std::filesystem::path& a, const std::filesystem::path& b,
                                  const ComparisonOptions& options = {});

}  // namespace elastocal
