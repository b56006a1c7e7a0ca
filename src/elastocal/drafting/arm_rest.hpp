// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/drafting/spheres.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Moves the chain's joints in the posture of rest `q` until its tip is well inside its box and its
/// spheres are free of the rest of the robot: of 4000 random postures that do, the one that is
/// nearest to `q`, in whole degrees. Returns whether there is one.
bool HoldAhead(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
               const std::vector<SpherePair>& pairs, const ChainSetup& chain, double margin,
               Eigen::VectorXd& q);

}  // namespace elastocal
