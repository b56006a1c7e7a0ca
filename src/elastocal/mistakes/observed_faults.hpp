// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// Description of a fault, with its correction.
std::string DescribeWithRemedy(const ObservationFault& fault, const ObservedRobot& model,
                               const Observations& observations);

/// Finds a fault of the tables that the estimate nearly explains (FindObservationFaults,
/// FindObservedScale), as a sentence with its correction; empty where there is none. The faults
/// that explain most of the residuals are corrected in turn, and the one whose fit leaves least is
/// named if that is less than half. A scale is found by the lengths of the robot instead.
std::string FindObservedFault(const ObservedRobot& model, const Observations& observations,
                              const ObservationFit& fit);

}  // namespace elastocal
