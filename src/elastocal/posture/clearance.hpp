// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/posture/constraint.hpp"
#include "elastocal/robot/collision.hpp"

namespace elastocal {

/// Eq. 11: distances between the surfaces of pairs of spheres are at least `margin` [m].
class SphereClearance : public PostureConstraint {
 public:
  SphereClearance(std::vector<CollisionSphere> spheres, std::vector<SpherePair> pairs,
                  double margin);
  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  std::vector<CollisionSphere> spheres_;
  std::vector<SpherePair> pairs_;
};

/// The chain's own spheres stay above a level floor at height `floor_z` in the root link's frame,
/// m. For a leg that swings while the other one stands.
class FloorClearance : public PostureConstraint {
 public:
  /// The caller must leave out spheres on links that do not move with the chain.
  FloorClearance(std::vector<CollisionSphere> spheres, double floor_z);
  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  std::vector<CollisionSphere> spheres_;
};

}  // namespace elastocal
