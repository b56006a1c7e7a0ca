// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/collision.hpp"

namespace elastocal {

Eigen::Matrix3Xd SphereCentres(const std::vector<CollisionSphere>& spheres,
                               const std::vector<Transform>& T_ref_link) {
  Eigen::Matrix3Xd centres(3, static_cast<Eigen::Index>(spheres.size()));
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    centres.col(static_cast<Eigen::Index>(s)) =
        T_ref_link[spheres[s].link] * spheres[s].p_link_centre;
  }
  return centres;
}

Eigen::VectorXd SphereDistances(const std::vector<CollisionSphere>& spheres,
                                const std::vector<SpherePair>& pairs,
                                const std::vector<Transform>& T_ref_link) {
  const Eigen::Matrix3Xd centres = SphereCentres(spheres, T_ref_link);
  Eigen::VectorXd distances(static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i];
    distances[static_cast<Eigen::Index>(i)] =
        (centres.col(a) - centres.col(b)).norm() - spheres[a].radius - spheres[b].radius;
  }
  return distances;
}

}  // namespace elastocal
