// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "elastocal/motion/standing_robot.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// The robot of a project with `contact`, balanced in its posture of rest, with its tables. Its
/// soles are at the feet of `contact`; z = 0 of the world is the floor, and the first foot's place
/// is the origin. Sets the poses of the set-up's feet (those of the project) that the project
/// leaves open. Without feet, the root link is held.
///
/// The clearances of the robot are those of its own parts, then one for each plate that has a
/// table; ContactNames names them. The clearance of a table is the least distance to it (a body
/// from the floor to its top) of the robot's spheres and of the plate's corners, plus the limit:
/// what lies on the table keeps the limit, and what is inside does not.
///
/// Throws InputError for a foot that is no sole of the section `standing`, and for a robot that
/// cannot stand there.
std::unique_ptr<StandingRobot> StandAtTables(const Project& project, const MotionLimits& limits,
                                             ObservationSetup& setup);

}  // namespace elastocal
