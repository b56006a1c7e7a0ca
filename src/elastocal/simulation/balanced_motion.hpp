// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// PlayMotion for a robot that stands freely on feet that are balls. The robot's controller keeps
/// it over its feet by a Stabiliser, which knows the robot as `described`. Encoders and torques are
/// those of the corrected motion. Throws InputError if the robot falls.
TrueMotion PlayBalanced(const TrueRobot& robot, const RobotTree& described,
                        const std::vector<int>& support, const Motion& motion,
                        const Transform& T_camera_world, const PhysicsOptions& options);

}  // namespace elastocal
