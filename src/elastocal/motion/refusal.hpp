#pragma once

#include <optional>

#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// Why a stretch of motion is not taken.
struct Refusal {
  Constraint constraint = Constraint::kReach;
  double value = 0.0;
  int index = -1;
};

/// What the margins say of the constraint that they break, if any.
std::optional<Refusal> Refuse(const MotionMargins& margins, const MotionLimits& limits);

/// That a foot is out of reach.
Refusal OutOfReach();

}  // namespace elastocal
