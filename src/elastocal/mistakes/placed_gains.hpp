// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/general_fault.hpp"

namespace elastocal {

/// Assigns gains of joints to trials. A gain of one size in all trials of the estimate is a fault
/// of these trials alone if held-out trials that move the joint do not have it. It then becomes one
/// fault for each trial of the estimate that moves the joint. Other faults, and gains of which no
/// held-out trial tells, stay unchanged. `undone` is the fitted recording with the faults
/// corrected.
std::vector<RecordingFault> PlaceGains(const std::vector<RecordingFault>& faults,
                                       const Recording& undone, const GeneralFault& general);

}  // namespace elastocal
