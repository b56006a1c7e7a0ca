// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/standing_feet.hpp"

#include <algorithm>

namespace elastocal {

Sole SoleOf(int foot, const PhysicsOptions& options) {
  for (const Sole& sole : options.soles) {
    if (sole.link == foot) return sole;
  }
  return {foot, {-0.10, -0.06}, {0.10, 0.06}};
}

int CountBalls(const std::vector<int>& support, const PhysicsOptions& options) {
  return static_cast<int>(std::count_if(support.begin(), support.end(), [&](int foot) {
    return SoleOf(foot, options).ball_radius.has_value();
  }));
}

bool StandsFreely(const std::vector<int>& support, const PhysicsOptions& options) {
  return options.standing == Standing::kFree || CountBalls(support, options) >= kBallsThatStand;
}

Transform PutOnBalls(const std::vector<int>& support, const PhysicsOptions& options,
                     const std::vector<Transform>& T_waist_link) {
  std::vector<Eigen::Vector3d> centres;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double height = 0.0;
  for (const int foot : support) {
    const Sole sole = SoleOf(foot, options);
    if (!sole.ball_radius) continue;
    centres.emplace_back(T_waist_link[static_cast<std::size_t>(foot)].translation());
    middle += centres.back();
    height += sole.height();
  }
  const auto count = static_cast<double>(centres.size());
  Transform T_world_waist = Transform::Identity();
  T_world_waist.linear() = FloorAxes(centres).transpose();
  T_world_waist.translation() =
      height / count * Eigen::Vector3d::UnitZ() - T_world_waist.linear() * middle / count;
  return T_world_waist;
}

}  // namespace elastocal
