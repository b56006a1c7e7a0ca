// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Joints that move markers and stood still in all postures, in a sentence; empty if there are
/// none.
std::string StillJoints(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
