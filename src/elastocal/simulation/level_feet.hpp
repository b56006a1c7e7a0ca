// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/simulation/true_robot.hpp"

namespace elastocal {

/// Feet of a robot that stand on one level floor for the whole of a recording.
///
/// A planner closes the loop of two legs with the described robot. The true legs would then push
/// the feet against each other. Here the legs give way, as with a controller that evens out the
/// moments of the feet: the legs' joints take the smallest change of position with which the true
/// feet lie flat. This is kinematics only; deflections by the weight are not corrected.
class LevelFeet {
 public:
  /// The first of `support` (feet of legs) stands where BuildMjcf puts it. The others lie flat
  /// where the posture `encoders` (by coordinate) has them. Keeps a reference to the robot. Throws
  /// std::invalid_argument for a link that is not the foot of a leg.
  LevelFeet(const TrueRobot& robot, const std::vector<int>& support,
            const Eigen::VectorXd& encoders);

  /// The posture (by coordinate) with the feet in their places.
  Eigen::VectorXd Yield(Eigen::VectorXd encoders) const;

  /// Poses of the standing feet; the floor is z = 0.
  const std::vector<Transform>& T_floor_foot() const { return T_floor_foot_; }

 private:
  /// Distances [m] and rotation vectors [rad] of the feet to their places, one after the other.
  Eigen::VectorXd Gaps(const Eigen::VectorXd& encoders) const;

  const TrueRobot& robot_;
  std::vector<int> support_, coordinates_;
  std::vector<Transform> T_floor_foot_;
};

}  // namespace elastocal
