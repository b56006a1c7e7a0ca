// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A sphere that stands for part of a link (paper section 3.1 and Fig. 2b).
struct CollisionSphere {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_link_centre = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.0;                                      ///< m
};

/// Indices of two spheres that can touch.
using SpherePair = std::pair<int, int>;

/// Centres of the spheres in the frame ref of `T_ref_link` (poses of all links), 3 x spheres, m.
Eigen::Matrix3Xd SphereCentres(const std::vector<CollisionSphere>& spheres,
                               const std::vector<Transform>& T_ref_link);

/// Distances between the surfaces of pairs of spheres, m; negative where they overlap (eq. 11).
Eigen::VectorXd SphereDistances(const std::vector<CollisionSphere>& spheres,
                                const std::vector<SpherePair>& pairs,
                                const std::vector<Transform>& T_ref_link);

}  // namespace elastocal
