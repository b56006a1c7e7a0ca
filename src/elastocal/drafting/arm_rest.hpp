// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "elastocal/drafting/spheres.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Changes the chain's joints in the posture of rest `q` so that its tip is well inside its box and
/// its spheres do not touch the rest of the robot. Joints with an entry in `ranges` (by entry of q)
/// stay in these. Of 4000 random postures, the nearest to `q` that does so is taken, rounded to
/// whole degrees. Returns whether there is one.
bool HoldAhead(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
               const std::vector<SpherePair>& pairs, const ChainSetup& chain, double margin,
               const std::map<int, Eigen::Vector2d>& ranges, Eigen::VectorXd& q);

}  // namespace elastocal
