// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/link_zmp.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/standing.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {

LinkZmp::Momentum LinkZmp::To(const std::vector<Transform>& T_world_link) const {
  Momentum momentum;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    if (link.mass == 0.0) continue;
    const Transform &from = T_world_link_[i], &to = T_world_link[i];
    const Eigen::Vector3d com = from * link.com, moved = to * link.com - com;
    const Eigen::Vector3d linear = link.mass / step_ * moved;
    const Eigen::Vector3d turned = RotationVector(to.linear() * from.linear().transpose());
    momentum.linear += linear;
    momentum.angular +=
        (com + 0.5 * moved).cross(linear) +
        from.linear() * (link.inertia * (from.linear().transpose() * turned)) / step_;
  }
  return momentum;
}

Eigen::Vector2d LinkZmp::Zmp(const Momentum& after) const {
  Eigen::Vector3d force = (after.linear - before_.linear) / step_;
  Eigen::Vector3d moment = (after.angular - before_.angular) / step_;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Eigen::Vector3d weight = links_[i].mass * kGravity;
    force -= weight;
    moment -= (T_world_link_[i] * links_[i].com).cross(weight);
  }
  return ZeroMomentPoint(force, moment);
}

std::optional<Eigen::Vector2d> LinkZmp::Next(const std::vector<Transform>& T_world_link) {
  std::optional<Eigen::Vector2d> zmp;
  if (!T_world_link_.empty()) {
    const Momentum after = To(T_world_link);
    zmp = Zmp(after);
    before_ = after;
  }
  T_world_link_ = T_world_link;
  return zmp;
}

Eigen::Vector2d LinkZmp::Last() const { return Zmp({}); }

Worst LeastAverageZmp(const StandingRobot& robot, const std::vector<std::vector<int>>& standing,
                      const Eigen::MatrixX2d& zmp, double step) {
  const auto each_side = std::lround(0.5 * std::sqrt(robot.leg_length / kGravity.norm()) / step);
  Worst least;
  Eigen::Index end = 0;  // end of the samples on the same feet
  for (Eigen::Index begin = 0; begin < zmp.rows(); begin = end) {
    const std::vector<int>& feet = standing[Size(begin)];
    while (end < zmp.rows() && standing[Size(end)] == feet) ++end;
    std::vector<Sole> soles;
    std::vector<Transform> T_world_sole;
    for (const int foot : feet) {
      soles.push_back(robot.soles[Size(foot)]);
      T_world_sole.push_back(robot.T_world_sole[Size(foot)]);
    }
    const Polygon support = SupportPolygon(soles, T_world_sole);
    for (Eigen::Index i = begin; i < end; ++i) {
      const Eigen::Index first = std::max<Eigen::Index>(begin, i - each_side);
      const Eigen::Index last = std::min<Eigen::Index>(end - 1, i + each_side);
      const Eigen::RowVector2d mean = zmp.middleRows(first, last - first + 1).colwise().mean();
      const double margin = InsideMargin(support, mean.transpose());
      if (least.sample < 0 || margin < least.value) least = {margin, static_cast<int>(i), -1};
    }
  }
  return least;
}

}  // namespace elastocal
