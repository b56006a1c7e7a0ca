// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/leave_room.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {
namespace {

constexpr double kMostShare = 0.1;    // share of a range, at either end
constexpr double kMostInside = 0.02;  // likewise: margin that design keeps by default

enum class WhereRestIsNear { kThrow, kLeaveLess };

/// Room at one end of a joint's range, and the end of the range of postures: these keep their
/// distance to the limit, which a motion needs for its balance.
struct End {
  double room = 0.0, kept = 0.0;
};

/// `gap`: of the range of postures to the limit; `rest`: of the posture of rest.
End RoomAt(double room, double range, double gap, double rest, WhereRestIsNear near) {
  const double inside = std::clamp(gap, 0.0, kMostInside * range);
  double left = std::min(room, kMostShare * range);
  if (near == WhereRestIsNear::kLeaveLess) left = std::clamp(rest - inside, 0.0, left);
  return {left, left + inside};
}

Project Narrowed(Project project, const Eigen::VectorXd& room_rad, WhereRestIsNear near) {
  constexpr double kDegreesARadian = 180.0 / M_PI;
  for (std::size_t c = 0; c < project.tree.coordinate_joint.size(); ++c) {
    Joint& joint = project.tree.joints[Size(project.tree.coordinate_joint[c])];
    const double range = joint.limits.upper - joint.limits.lower;
    const auto i = static_cast<Eigen::Index>(c);
    if (joint.type != JointType::kRevolute || !std::isfinite(range) || range <= 0.0) continue;
    if (!(room_rad[i] > 0.0)) continue;
    double &lower = project.motion.lower[i], &upper = project.motion.upper[i];
    const double rest = project.motion.rest[i];
    const End low =
        RoomAt(room_rad[i], range, lower - joint.limits.lower, rest - joint.limits.lower, near);
    const End high =
        RoomAt(room_rad[i], range, joint.limits.upper - upper, joint.limits.upper - rest, near);
    lower = std::max(lower, joint.limits.lower + low.kept);
    upper = std::min(upper, joint.limits.upper - high.kept);
    joint.limits.lower += low.room;
    joint.limits.upper -= high.room;
    if (rest >= lower && rest <= upper) continue;
    if (near == WhereRestIsNear::kLeaveLess) {  // by rounding
      lower = std::min(lower, rest);
      upper = std::max(upper, rest);
      continue;
    }
    throw InputError(fmt::format(
        "{}: the posture of rest has joint '{}' at {:.2f} deg; with {:.2f} deg left free at its "
        "limits, a position from {:.2f} to {:.2f} deg was expected (design.rest_deg, or less room)",
        project.file.string(), joint.name, rest * kDegreesARadian, low.room * kDegreesARadian,
        lower * kDegreesARadian, upper * kDegreesARadian));
  }
  return project;
}

/// By coordinate: whether it moves a sole against the root link.
std::vector<bool> MovesAFoot(const Project& project) {
  std::vector<bool> moves(project.tree.coordinate_joint.size(), false);
  for (const Sole& sole : project.soles) {
    for (const int c : ChainCoordinates(project.tree, 0, sole.link)) moves[Size(c)] = true;
  }
  return moves;
}

}  // namespace

Project LeaveRoom(Project project, double room_rad) {
  const Eigen::VectorXd room = Eigen::VectorXd::Constant(project.tree.coordinate_count(), room_rad);
  return Narrowed(std::move(project), room, WhereRestIsNear::kThrow);
}

Project LeavePossibleRoom(Project project, const Eigen::VectorXd& room_rad) {
  return Narrowed(std::move(project), room_rad, WhereRestIsNear::kLeaveLess);
}

Project KeepRanges(Project project, const RobotTree& own) {
  constexpr double kRounding = 1e-9;
  const std::vector<bool> moves_a_foot = MovesAFoot(project);
  for (std::size_t c = 0; c < project.tree.coordinate_joint.size(); ++c) {
    const int k = project.tree.coordinate_joint[c];
    const JointLimits& described = own.joints[Size(k)].limits;
    const double inside = kMostInside * (described.upper - described.lower);
    if (moves_a_foot[c] || !std::isfinite(inside)) continue;
    JointLimits& limits = project.tree.joints[Size(k)].limits;
    const auto i = static_cast<Eigen::Index>(c);
    const double lower = project.motion.lower[i] - inside, upper = project.motion.upper[i] + inside;
    if (lower > limits.lower + kRounding) limits.lower = lower;
    if (upper < limits.upper - kRounding) limits.upper = upper;
  }
  return project;
}

Project WithRoom(Project project, const std::optional<double>& room_deg) {
  const RobotTree own = project.tree;
  if (room_deg) return KeepRanges(LeaveRoom(std::move(project), *room_deg * M_PI / 180.0), own);
  const Eigen::VectorXd room = project.motion.room;
  return KeepRanges(LeavePossibleRoom(std::move(project), room), own);
}

}  // namespace elastocal
