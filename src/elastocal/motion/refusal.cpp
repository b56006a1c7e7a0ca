// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/refusal.hpp"

#include <limits>

namespace elastocal {

std::optional<Refusal> Refuse(const MotionMargins& margins, const MotionLimits& limits) {
  const auto broken = Broken(margins, limits);
  if (!broken) return std::nullopt;
  const auto because = [&](const Worst& worst) {
    return Refusal{*broken, worst.value, worst.index};
  };
  switch (*broken) {
    case Constraint::kPosition:
      return because(margins.position);
    case Constraint::kVelocity:
      return because(margins.velocity);
    case Constraint::kTorque:
      return because(margins.torque);
    case Constraint::kClearance:
      return because(margins.clearance);
    case Constraint::kZmp:
      return because(margins.zmp);
    case Constraint::kFriction:
      return because(margins.friction);
    case Constraint::kKnee:
      return because(margins.knee);
    case Constraint::kFeet:
      return because(margins.foot_moved);
    case Constraint::kFloor:
      return because(margins.floor);
    case Constraint::kLever:
      return because(margins.lever);
    case Constraint::kReach:
    case Constraint::kApproach:
      break;
  }
  return OutOfReach();
}

Refusal OutOfReach() { return {Constraint::kReach, std::numeric_limits<double>::quiet_NaN(), -1}; }

}  // namespace elastocal
