// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// Finds faults that explain most of the residuals of a fit. Each fault is tested as one more
/// unknown beside all others (score test), so that it is not confused with errors of the robot that
/// explain the same. Observations that were left out take part with a limited weight. A fault is
/// returned if its size matters (gain 0.5 %; scale and size of tags 0.3 %; offset and drift 0.25
/// degrees or 1 mm; displacement 0.5 mm or 0.05 degrees), if it is certain (four standard
/// deviations, in noise that contains the fault), and if it explains at least a tenth of the
/// squared residuals. At most one fault is returned for each joint or quantity, the one that
/// explains most first. Frozen joints are those with exactly the same logged position in at least
/// five consecutive postures whose residuals are larger than the others'.
std::vector<ObservationFault> FindObservationFaults(const ObservedRobot& model,
                                                    const Observations& observations,
                                                    const ObservationFit& fit);

/// The fault with its size refined by the residuals of a fit without it, because the score test
/// gives it to first order only. The standard deviation is kept: that of a fit without the fault
/// does not contain the model's errors. Frozen positions and displacements are returned unchanged.
ObservationFault Refined(ObservationFault fault, const ObservedRobot& model,
                         const Observations& observations);

}  // namespace elastocal
