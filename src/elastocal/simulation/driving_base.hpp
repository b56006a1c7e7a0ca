// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// Lets the base of a robot drive on the level floor while it moves from one rest to the next: what
/// happened in `played`, on a root link that was held at T_camera_world, happens at places within
/// `kDrivingSpan` of there, in directions within `kDrivingTurn`. The base stands still wherever
/// `commanded` does, and starts and stops smoothly; it is so slow that the arm does not feel it.
void DriveBase(const Motion& commanded, const Transform& T_camera_world, std::uint64_t seed,
               TrueMotion& played);

inline constexpr double kDrivingSpan = 0.3;  ///< m, in either direction of the floor
inline constexpr double kDrivingTurn = 0.5;  ///< rad, about the vertical

}  // namespace elastocal
