// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// The part of a robot from a link outwards, as a robot of its own: the link's body becomes the
/// root body. Names stay; coordinates are numbered anew.
RobotTree Subtree(const RobotTree& tree, int link);

/// Markers whose links are in the subtree, with the link numbers of the subtree. Others are left
/// out.
std::vector<Marker> SubtreeMarkers(const RobotTree& tree, const RobotTree& subtree,
                                   const std::vector<Marker>& markers);

}  // namespace elastocal
