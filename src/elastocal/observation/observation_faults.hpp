// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// Looks for the faults that explain most of what a fit has left: each is one more unknown beside
/// all others (score test), so that it is not confused with what errors of the robot explain as
/// well. Observations that were left out take part with a limited weight. Returned are those of a
/// size that matters (gain 0.5 %; scale 0.3 %; offset, drift 0.25 degrees, 1 mm; move 0.5 mm, 0.05
/// degrees), certain
/// (four standard deviations, in noise that has the fault in it) and a tenth of what is left, the
/// one that explains most first, one for each joint or quantity; among them joints that are logged
/// in exactly the same place in five and more postures that follow each other, which are worse than
/// the others.
std::vector<ObservationFault> FindObservationFaults(const ObservedRobot& model,
                                                    const Observations& observations,
                                                    const ObservationFit& fit);

/// The fault with its size refined, by what is left of it beside a fit without it: the score test
/// tells it to first order. The standard deviation stays: that of a fit without the fault does not
/// know what the model lacks. Frozen positions and what was moved stay as they are.
ObservationFault Refined(ObservationFault fault, const ObservedRobot& model,
                         const Observations& observations);

}  // namespace elastocal
