#pragma once

#include <vector>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// The part of a robot that a link carries, as a robot of its own: the link's body becomes the root
/// body, and its joints are beyond it. Names stay; coordinates are numbered anew.
RobotTree Subtree(const RobotTree& tree, int link);

/// Markers whose links are in the subtree, on its own link numbers; others are left out.
std::vector<Marker> SubtreeMarkers(const RobotTree& tree, const RobotTree& subtree,
                                   const std::vector<Marker>& markers);

}  // namespace elastocal
