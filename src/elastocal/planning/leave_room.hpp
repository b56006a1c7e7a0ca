// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/project/project.hpp"

namespace elastocal {

/// The project with the limits of its turning joints so much nearer to each other at either end,
/// rad, but at most by a tenth of a joint's range: what commands that are corrected later may need
/// beyond what is planned. Ranges of postures follow. Throws InputError where the posture of rest
/// is then beyond a limit.
Project LeaveRoom(Project project, double room_rad);

}  // namespace elastocal
