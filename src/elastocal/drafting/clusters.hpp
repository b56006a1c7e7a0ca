// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// Three markers on a body, as they are drafted.
struct DraftedCluster {
  std::string name;
  int body = 0;
  std::array<Eigen::Vector3d, 3> points;  ///< in the body's frame, m, whole millimetres
  bool guessed = false;                   ///< the body's shape is not known
};

/// Bodies of a limb that get markers: its last one, and every other one that is more than a joint
/// of a compound (hip, ankle, wrist), where the axes of the joints before and after it meet and
/// nothing reaches far from there.
std::vector<int> MarkedBodies(const RobotTree& tree, const RobotShapes& shapes, const Limb& limb);

/// Clusters of three for the root and for the marked bodies of all limbs. Their markers are on the
/// shapes, away from the floor, seen in the posture of rest, and no two distances in a cluster are
/// alike: the shortest is at most 0.88 of the middle one, and that of the longest. Limbs that are
/// mirror images have mirrored clusters.
std::vector<DraftedCluster> PlaceClusters(const RobotTree& tree, const RobotShapes& shapes,
                                          const Limbs& limbs, const Eigen::VectorXd& rest);

}  // namespace elastocal
