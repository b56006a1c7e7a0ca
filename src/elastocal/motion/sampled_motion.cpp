// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/sampled_motion.hpp"

#include <algorithm>

#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

RobotState StateAt(const Eigen::MatrixXd& q, const std::vector<Transform>& T_world_root,
                   double step, Eigen::Index sample) {
  const Eigen::Index before = std::max<Eigen::Index>(sample - 1, 0);
  const Eigen::Index after = std::min(sample + 1, q.rows() - 1);
  const Transform& at = T_world_root[static_cast<std::size_t>(sample)];
  const Transform& earlier = T_world_root[static_cast<std::size_t>(before)];
  const Transform& later = T_world_root[static_cast<std::size_t>(after)];
  const Eigen::Vector3d turned = RotationVector(at.linear() * earlier.linear().transpose());
  const Eigen::Vector3d turning = RotationVector(later.linear() * at.linear().transpose());
  RobotState state;
  state.T_world_root = at;
  state.root_velocity = (later.translation() - earlier.translation()) / (2.0 * step);
  state.root_acceleration =
      (later.translation() - 2.0 * at.translation() + earlier.translation()) / (step * step);
  state.root_turn = (turned + turning) / (2.0 * step);
  state.root_turn_rate = (turning - turned) / (step * step);
  state.q = q.row(sample).transpose();
  state.velocity = (q.row(after) - q.row(before)).transpose() / (2.0 * step);
  state.acceleration =
      (q.row(after) - 2.0 * q.row(sample) + q.row(before)).transpose() / (step * step);
  return state;
}

Eigen::MatrixX2d ZeroMomentPoints(const StandingRobot& robot, const Eigen::MatrixXd& q,
                                  const std::vector<Transform>& T_world_root, double step) {
  Eigen::MatrixX2d zmp(q.rows(), 2);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const InverseDynamicsResult floor =
        InverseDynamics(robot.tree, robot.inertias, StateAt(q, T_world_root, step, i), kGravity);
    zmp.row(i) = ZeroMomentPoint(floor.force, floor.moment).transpose();
  }
  return zmp;
}

}  // namespace elastocal
