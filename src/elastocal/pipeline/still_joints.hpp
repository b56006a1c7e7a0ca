// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A sentence that names the joints that move markers but stood still in all postures; empty if
/// there are none.
std::string StillJoints(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
