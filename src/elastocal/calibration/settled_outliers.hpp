// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/outliers.hpp"
#include "elastocal/identifiability/base_parameters.hpp"

namespace elastocal {

struct EquationCount {
  Eigen::Index equations = 0;
  /// Identifiable parameters that no earlier calibration tells, and six for each pose of waist or
  /// footing.
  Eigen::Index unknowns = 0;
  bool enough() const { return equations >= unknowns; }
};

EquationCount CountEquations(const FitProblem& problem, const Placement& placement,
                             const Selection& selection, const BaseParameters& base,
                             const std::vector<int>& free);

/// Judges outliers with the noise of single moments: correlations within motions are ignored.
OutlierVerdict JudgeOutliers(const FitProblem& problem, const Selection& selection,
                             const std::vector<int>& free, Fit fit);

/// Fits without the outliers of a verdict and judges anew, until the verdict no longer changes. An
/// observation at the limit may be left out and taken back in turns; it then stays out. Where too
/// few equations would be left, all observations are kept: so many cannot all be outliers, and the
/// true cause is not known yet. `updates` is that of FitParameters.
OutlierVerdict SettleOutliers(const FitProblem& problem, const BaseParameters& base,
                              const std::vector<int>& free, int updates, OutlierVerdict verdict,
                              Selection& selection, Fit& fit, bool& too_many);

}  // namespace elastocal
