#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// How the coordinates of a chain on one side follow from those of its mirror image on the other:
/// x_other = sign .* x, in the order of the chains.
struct MirrorMap {
  Eigen::VectorXd sign;
};

/// Compares two chains (coordinates from the root outwards) in the zero posture, reflected at the
/// root link's x-z plane: axes must agree within `angle` [rad] and origins, along the axis, within
/// `distance` [m]. Nothing, and why in `reason`, where they are no mirror images.
///
/// A rotation by q about an axis a through o becomes, reflected by S = diag(1, -1, 1), one by q
/// about -S a through S o.
std::optional<MirrorMap> FindMirror(const RobotTree& tree, const std::vector<int>& coordinates,
                                    const std::vector<int>& other, std::string* reason = nullptr,
                                    double angle = 1e-2, double distance = 2e-3);

}  // namespace elastocal
