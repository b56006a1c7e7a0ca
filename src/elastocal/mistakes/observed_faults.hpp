// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// A fault in words, with what undoes it.
std::string DescribeWithRemedy(const ObservationFault& fault, const ObservedRobot& model,
                               const Observations& observations);

/// A fault of the tables that the estimate nearly explains (FindObservationFaults,
/// FindObservedScale), in a sentence with what undoes it; empty where there is none. The faults
/// that explain most of what is left are undone in turn, and the one whose fit leaves least is
/// taken if that is less than half. A scale is told by the lengths of the robot instead.
std::string FindObservedFault(const ObservedRobot& model, const Observations& observations,
                              const ObservationFit& fit);

}  // namespace elastocal
