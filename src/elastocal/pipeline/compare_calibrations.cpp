// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/compare_calibrations.hpp"

namespace elastocal {

ComparisonRun CompareCalibrations(const std::filesystem::path& a, const std::filesystem::path& b,
                                  const ComparisonOptions& options) {
  ComparisonRun run{ReadCalibrationFiles(FindCalibrationFiles(a)),
                    ReadCalibrationFiles(FindCalibrationFiles(b)),
                    {}};
  run.comparison = CompareCalibrations(run.a, run.b, options);
  return run;
}

}  // namespace elastocal
