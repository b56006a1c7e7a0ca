// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/variances.hpp"

namespace elastocal {

/// How errors of the model are correlated between moments of one motion (MotionOfPostures), by
/// group: the displacement that the markers of a body share (NoiseSource::kBodyPosition), and what
/// the constraint of the standing foot leaves. With the correlation rho_k at k samples of distance,
/// a sum of n moments has 1 + 2 sum (1 - k/n) rho_k times the variance of as many independent
/// postures. The sum goes to where the correlation has fallen to zero, so that for a first-order
/// process it is (1 + rho_1) / (1 - rho_1), and on over those distances at which it is larger than
/// chance makes it (Bartlett 1946): a motion that repeats itself repeats its errors.
///
/// By the residuals as last evaluated, from which is taken out what the poses and the parameters
/// explain of them. Noise of single markers is not correlated. Empty where the recording has no
/// motion; 1 for a group with fewer than ten pairs of moments. A group in which bodies
/// share little of the variance (5 %) keeps what `noise` says of them where that matters: weighted
/// by their correlation, they would tell none, and weighted by none a large one again.
std::vector<MotionCorrelation> FindMotionCorrelation(const FitProblem& problem,
                                                     const Selection& selection, const Noise& noise,
                                                     const BodyResiduals& residuals,
                                                     const ExplainedRows& explained);

}  // namespace elastocal
