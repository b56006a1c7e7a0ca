// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/leave_room.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kMostShare = 0.1;    // share of a range, at either end
constexpr double kMostInside = 0.02;  // likewise: margin that design keeps by default

}  // namespace

Project LeaveRoom(Project project, double room_rad) {
  constexpr double kDegreesARadian = 180.0 / M_PI;
  if (!(room_rad > 0.0)) return project;
  for (std::size_t c = 0; c < project.tree.coordinate_joint.size(); ++c) {
    Joint& joint = project.tree.joints[Size(project.tree.coordinate_joint[c])];
    const double range = joint.limits.upper - joint.limits.lower;
    if (joint.type != JointType::kRevolute || !std::isfinite(range) || range <= 0.0) continue;
    const double room = std::min(room_rad, kMostShare * range);
    const auto i = static_cast<Eigen::Index>(c);
    double &lower = project.motion.lower[i], &upper = project.motion.upper[i];
    // Postures keep their distance to the limits, which a motion needs for its balance.
    const auto kept = [&](double gap) { return room + std::clamp(gap, 0.0, kMostInside * range); };
    lower = std::max(lower, joint.limits.lower + kept(lower - joint.limits.lower));
    upper = std::min(upper, joint.limits.upper - kept(joint.limits.upper - upper));
    joint.limits.lower += room;
    joint.limits.upper -= room;
    const double rest = project.motion.rest[i];
    if (rest >= project.motion.lower[i] && rest <= project.motion.upper[i]) continue;
    throw InputError(fmt::format(
        "{}: the posture of rest has joint '{}' at {:.2f} deg; with {:.2f} deg left free at its "
        "limits, a position from {:.2f} to {:.2f} deg was expected (design.rest_deg, or less room)",
        project.file.string(), joint.name, rest * kDegreesARadian, room * kDegreesARadian,
        project.motion.lower[i] * kDegreesARadian, project.motion.upper[i] * kDegreesARadian));
  }
  return project;
}

}  // namespace elastocal
