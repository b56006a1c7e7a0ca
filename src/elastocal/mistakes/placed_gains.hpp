// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/general_fault.hpp"

namespace elastocal {

/// Gains of joints that the trials of the estimate show, all of them with one size, are gains of
/// these trials alone where held-out trials that move the joint do not have them: each is then one
/// fault for each trial of the estimate that moves it. Other faults, and gains of which no held-out
/// trial tells, stay as they are. `undone`: what was fitted, without the faults.
std::vector<RecordingFault> PlaceGains(const std::vector<RecordingFault>& faults,
                                       const Recording& undone, const GeneralFault& general);

}  // namespace elastocal
