// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// Names of trials: "arms, leg_left".
std::string TrialNames(const Recording& recording, const std::vector<int>& trials);

/// The trials that have a posture of which this holds, ascending.
std::vector<int> TrialsWith(const Recording& recording, const std::function<bool(int)>& holds_of);

}  // namespace elastocal
