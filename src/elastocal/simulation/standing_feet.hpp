// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/simulation/mjcf.hpp"

namespace elastocal {

/// What of a foot (a link) touches the floor, see PhysicsOptions::soles.
Sole SoleOf(int foot, const PhysicsOptions& options);

/// How many of the feet of `support` are balls.
int CountBalls(const std::vector<int>& support, const PhysicsOptions& options);

/// So many balls carry a robot by themselves.
inline constexpr int kBallsThatStand = 3;

/// Whether the feet of `support` lie on the floor by contact: as the options say, and always where
/// they are balls that carry the robot, which nothing could hold.
bool StandsFreely(const std::vector<int>& support, const PhysicsOptions& options);

/// Pose of the waist in the world in which the balls of `support` touch the floor z = 0, as nearly
/// as they can, their middle over the origin.
Transform PutOnBalls(const std::vector<int>& support, const PhysicsOptions& options,
                     const std::vector<Transform>& T_waist_link);

}  // namespace elastocal
