// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Relation of the coordinates of a chain on one side to those of its mirror image on the other:
/// x_other = sign .* x, in the order of the chains.
struct MirrorMap {
  Eigen::VectorXd sign;
};

/// Compares two chains (coordinates from the root outwards) in the zero posture, reflected at the
/// root link's x-z plane: axes must agree within `angle` [rad] and origins within `distance` [m]
/// (the place along a revolute axis does not matter). If the chains are not mirror images, the
/// result is empty, and `reason` says why.
///
/// Reflected by S = diag(1, -1, 1), a rotation by q about an axis a through o becomes a rotation by
/// q about -S a through S o.
std::optional<MirrorMap> FindMirror(const RobotTree& tree, const std::vector<int>& coordinates,
                                    const std::vector<int>& other, std::string* reason = nullptr,
                                    double angle = 1e-2, double distance = 2e-3);

}  // namespace elastocal
