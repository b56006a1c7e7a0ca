// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// Why a stretch of motion is refused.
struct Refusal {
  Constraint constraint = Constraint::kReach;
  double value = 0.0;
  int index = -1;
};

/// The constraint that the margins break, if any, with its value.
std::optional<Refusal> Refuse(const MotionMargins& margins, const MotionLimits& limits);

/// The refusal for a foot that is out of reach.
Refusal OutOfReach();

}  // namespace elastocal
