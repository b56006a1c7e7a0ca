// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "elastocal/motion/standing_robot.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// The robot of a project with `contact`, balanced in its posture of rest, with its tables. Its
/// soles are where the feet of `contact` stand, z = 0 of the world is the floor, and the first
/// foot's place is the origin. Fills in where the feet of the set-up (that of the project) stand,
/// as far as the project leaves it open. Without feet, the root link is held.
///
/// The clearances of the robot are those of its own parts and then one for each plate that has a
/// table; ContactNames names them. That of a table is the least distance to it (a body from the
/// floor to the top) of the robot's spheres and of the corners of the plate, to which the limit is
/// added: what lies on the table keeps the limit, and what is in it does not.
///
/// Throws InputError for a foot that is no sole of the section `standing`, and for a robot that
/// cannot stand there.
std::unique_ptr<StandingRobot> StandAtTables(const Project& project, const MotionLimits& limits,
                                             ObservationSetup& setup);

}  // namespace elastocal
