// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"

namespace elastocal {

/// How the displacement that the markers of a body share (NoiseSource::kBodyPosition) is
/// correlated between moments of one motion (MotionOfPostures), by group. With the correlation
/// rho_k at k samples of distance, a sum of moments has 1 + 2 sum rho_k times the variance of as
/// many independent postures; the sum goes to where the correlation has fallen to zero, so that for
/// a first-order process it is (1 + rho_1) / (1 - rho_1). Noise of single markers is taken out of
/// the variance. By the residuals as last evaluated. Empty where the recording has no motion; 1 for
/// a group with fewer than ten pairs of moments.
std::vector<MotionCorrelation> FindMotionCorrelation(const FitProblem& problem,
                                                     const Selection& selection, const Noise& noise,
                                                     const BodyResiduals& residuals);

}  // namespace elastocal
