// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/variances.hpp"

namespace elastocal {

/// Correlation of the model's errors between moments of one motion (MotionOfPostures), by group:
/// that of the displacement that the markers of a body share (NoiseSource::kBodyPosition), and that
/// of the residual of the standing foot's constraint. With the correlation rho_k at a lag of k
/// samples, a sum of n moments has 1 + 2 sum (1 - k/n) rho_k times the variance of n independent
/// postures. The sum extends to the lag where the correlation has fallen to zero, so that for a
/// first-order process it is (1 + rho_1) / (1 - rho_1). It also contains later lags at which the
/// correlation is larger than chance makes it (Bartlett 1946): a motion that repeats itself repeats
/// its errors.
///
/// The correlation is computed from the residuals as last evaluated, corrected for what poses and
/// parameters explain of them. Noise of single markers is not correlated. Returns nothing where the
/// recording has no motion. A group with fewer than ten pairs of moments has `samples_each` 1. A
/// group in which the shared displacement of bodies is less than 5 % of the variance keeps its
/// value in `noise` where that value matters; otherwise the weight of its bodies would oscillate.
std::vector<MotionCorrelation> FindMotionCorrelation(const FitProblem& problem,
                                                     const Selection& selection, const Noise& noise,
                                                     const BodyResiduals& residuals,
                                                     const ExplainedRows& explained);

}  // namespace elastocal
