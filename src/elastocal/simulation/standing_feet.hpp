// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/simulation/mjcf.hpp"

namespace elastocal {

/// Sole of a foot (a link), see PhysicsOptions::soles.
Sole SoleOf(int foot, const PhysicsOptions& options);

/// Number of feet of `support` that are balls.
int CountBalls(const std::vector<int>& support, const PhysicsOptions& options);

/// Least number of balls that carry a robot by themselves.
inline constexpr int kBallsThatStand = 3;

/// Whether the feet of `support` stand on the floor by contact and friction: if the options say so
/// (Standing::kFree), and always if three or more are balls, which no constraint could hold.
bool StandsFreely(const std::vector<int>& support, const PhysicsOptions& options);

/// Pose of the waist in the world in which the balls of `support` touch the floor z = 0, as nearly
/// as they can, with the mean of their centres over the origin. `T_waist_link`: poses of all links.
Transform PutOnBalls(const std::vector<int>& support, const PhysicsOptions& options,
                     const std::vector<Transform>& T_waist_link);

}  // namespace elastocal
