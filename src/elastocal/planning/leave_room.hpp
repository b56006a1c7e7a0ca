// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// The project with narrower limits of its revolute joints: by `room_rad` at either end, but by at
/// most a tenth of a joint's range. This leaves room for later corrections of the planned commands.
/// Ranges of postures follow. Throws InputError where the posture of rest is then beyond a limit.
Project LeaveRoom(Project project, double room_rad);

/// As LeaveRoom, with a room for each coordinate. A joint that rests near its limit leaves as much
/// as its posture of rest allows, and nothing is thrown.
Project LeavePossibleRoom(Project project, const Eigen::VectorXd& room_rad);

/// The project whose joints that move no foot have their range of postures (design.range_deg) as
/// limits, beyond which a motion has a fiftieth of the range for its ways. `own` is the robot with
/// the limits of its description.
Project KeepRanges(Project project, const RobotTree& own);

/// LeaveRoom with the room of the command line, deg, where it is given, and else LeavePossibleRoom
/// with that of the project (MotionSetup::room); then KeepRanges.
Project WithRoom(Project project, const std::optional<double>& room_deg);

}  // namespace elastocal
