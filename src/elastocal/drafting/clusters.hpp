// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// Three drafted markers on a body.
struct DraftedCluster {
  std::string name;
  int body = 0;
  std::array<Eigen::Vector3d, 3> points;  ///< in the body's frame, m, whole millimetres
  bool guessed = false;                   ///< the body's shape is unknown
};

/// Bodies of a limb that get markers: the last one, and every other one that is more than a joint
/// of a compound (hip, ankle, wrist). In a compound the axes of the joints before and after the
/// body meet, and no part of the body reaches far from there.
std::vector<int> MarkedBodies(const RobotTree& tree, const RobotShapes& shapes, const Limb& limb);

/// Places clusters of three markers on the root link and on the marked bodies of all limbs. Markers
/// are on the shapes, away from the floor and visible in the posture of rest. No two distances in a
/// cluster are similar: the shortest is at most 0.88 of the middle one, and that one at most 0.88
/// of the longest. Mirrored limbs have mirrored clusters.
std::vector<DraftedCluster> PlaceClusters(const RobotTree& tree, const RobotShapes& shapes,
                                          const Limbs& limbs, const Eigen::VectorXd& rest);

}  // namespace elastocal
