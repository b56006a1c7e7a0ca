// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// The zero-moment point of a robot by the poses of its links alone, whatever moves them: joints,
/// or springs between them. Masses are those of the tree. The robot rests before the first sample
/// and after the last one.
class LinkZmp {
 public:
  /// `step`: between samples, s.
  LinkZmp(const RobotTree& tree, double step) : links_(tree.links), step_(step) {}

  /// Takes the next sample, the pose of each link in a world whose floor is z = 0. Returns the
  /// zero-moment point of the sample before it, m; nothing at the first one.
  std::optional<Eigen::Vector2d> Next(const std::vector<Transform>& T_world_link);

  /// That of the last sample.
  Eigen::Vector2d Last() const;

 private:
  /// Between two samples: momentum, and angular momentum about the world's origin.
  struct Momentum {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
  };
  Momentum To(const std::vector<Transform>& T_world_link) const;
  /// Of the sample that was taken last.
  Eigen::Vector2d Zmp(const Momentum& after) const;

  const std::vector<Link>& links_;
  double step_;
  std::vector<Transform> T_world_link_;
  Momentum before_;
};

/// Least distance of zero-moment points (samples x 2, m) to the edge of the support, each averaged
/// over the samples of the same support in the time in which the robot falls, the square root of
/// leg length by gravity. What is shorter tips no robot over: a step of a joint's speed from one
/// sample to the next, which no drive follows, has its point metres away for one sample. `standing`
/// as in SampledMotion.
Worst LeastAverageZmp(const StandingRobot& robot, const std::vector<std::vector<int>>& standing,
                      const Eigen::MatrixX2d& zmp, double step);

}  // namespace elastocal
