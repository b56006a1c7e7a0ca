// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/compare_calibrations.hpp"

#include "elastocal/io/calibration_file.hpp"

namespace elastocal {

ComparisonRun CompareCalibrations(const std::filesystem::path& a, const std::filesystem::path& b,
                                  const ComparisonOptions& options) {
  const CalibrationFiles files_a = FindCalibrationFiles(a), files_b = FindCalibrationFiles(b);
  ComparisonRun run{ReadCalibrationFiles(files_a), ReadCalibrationFiles(files_b), {}, {}};
  run.comparison = CompareCalibrations(run.a, run.b, options);
  run.soles = CompareSoles(ReadCalibration(files_a.calibration).soles,
                           ReadCalibration(files_b.calibration).soles);
  return run;
}

}  // namespace elastocal
