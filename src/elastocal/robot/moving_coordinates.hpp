// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// The coordinates of q, ascending, that move what the model has parameters of: not those of other
/// limbs, grippers and wheels.
std::vector<int> MovingCoordinates(const ErrorModel& model);

}  // namespace elastocal
