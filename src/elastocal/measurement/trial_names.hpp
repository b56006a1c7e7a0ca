// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// The names of trials in one text: "arms, leg_left".
std::string TrialNames(const Recording& recording, const std::vector<int>& trials);

/// Indices of the trials that have a posture for which `holds_of` is true, ascending.
std::vector<int> TrialsWith(const Recording& recording, const std::function<bool(int)>& holds_of);

}  // namespace elastocal
