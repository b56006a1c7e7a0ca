// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// The zero-moment point of a robot by the poses of its links alone, whether joints or springs move
/// them. Masses are those of the tree. The robot is taken to rest before the first sample and after
/// the last one.
class LinkZmp {
 public:
  /// `step` is the time between samples, s.
  LinkZmp(const RobotTree& tree, double step) : links_(tree.links), step_(step) {}

  /// Takes the next sample, the pose of each link in a world whose floor is z = 0. Returns the
  /// zero-moment point of the sample before it, m; nothing at the first one.
  std::optional<Eigen::Vector2d> Next(const std::vector<Transform>& T_world_link);

  /// Zero-moment point of the last sample, m.
  Eigen::Vector2d Last() const;

 private:
  /// Between two samples: momentum, and angular momentum about the world's origin.
  struct Momentum {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  };
  Momentum To(const std::vector<Transform>& T_world_link) const;
  /// Zero-moment point of the sample that was taken last, given the momentum after it, m.
  Eigen::Vector2d Zmp(const Momentum& after) const;

  const std::vector<Link>& links_;
  double step_;
  std::vector<Transform> T_world_link_;
  Momentum before_;
};

/// Least distance of averaged zero-moment points to the edge of the support polygon, m; negative
/// outside. `zmp` is samples x 2, m. Each point is averaged over those samples around it that are
/// on the same feet, within the time in which the robot would fall, sqrt(leg length / gravity).
/// Anything shorter does not tip a robot over: a step of a joint's speed between two samples, which
/// no drive follows, puts the point metres away for one sample. `standing` is as in SampledMotion.
Worst LeastAverageZmp(const StandingRobot& robot, const std::vector<std::vector<int>>& standing,
                      const Eigen::MatrixX2d& zmp, double step);

}  // namespace elastocal
