// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// A posture as people find it again: "posture 12", or "trial leg_left, posture 3".
std::string DescribePosture(const Recording& recording, int posture);

/// The marker seen in a posture as people find it again: "posture 12 (line 14), marker LHAND_1".
std::string DescribeObservation(const Recording& recording, int posture, int marker);

}  // namespace elastocal
