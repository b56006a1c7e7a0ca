// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// Lets the root link of a robot drive on the level floor while the robot moves from one rest to
/// the next. `played` is a motion whose root link was held at T_camera_world; its markers and root
/// poses are moved to places within `kDrivingSpan` of there, with headings within `kDrivingTurn`.
/// The root link stands still wherever `commanded` does, and starts and stops smoothly. It is taken
/// to drive so slowly that the arm's dynamics do not change.
void DriveBase(const Motion& commanded, const Transform& T_camera_world, std::uint64_t seed,
               TrueMotion& played);

inline constexpr double kDrivingSpan = 0.3;  ///< m, in either direction of the floor
inline constexpr double kDrivingTurn = 0.5;  ///< rad, about the vertical

}  // namespace elastocal
