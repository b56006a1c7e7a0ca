// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/project/project.hpp"

namespace elastocal {

/// The project with narrower limits of its revolute joints: by `room_rad` at either end, but by at
/// most a tenth of a joint's range. This leaves room for later corrections of the planned commands.
/// Ranges of postures follow. Throws InputError where the posture of rest is then beyond a limit.
Project LeaveRoom(Project project, double room_rad);

}  // namespace elastocal
