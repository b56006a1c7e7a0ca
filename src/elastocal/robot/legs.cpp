// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/legs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elastocal {

std::vector<Leg> FindLegs(const RobotTree& tree, const std::vector<NamedChain>& chains) {
  constexpr double kSameFloor = 0.02, kLeastLeg = 0.1;  // shares of the robot's size
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tree.coordinate_count());
  const std::vector<Transform> T_root_link = LinkTransforms(tree, zero);
  const double tolerance = kSameFloor * RobotSize(tree);
  const auto height = [&](int link) { return T_root_link[link].translation().z(); };
  double lowest = std::numeric_limits<double>::infinity();
  for (const NamedChain& chain : chains) lowest = std::min(lowest, height(chain.tip_link));
  const bool root_on_floor = std::abs(lowest) <= tolerance;
  std::vector<Leg> legs;
  for (const NamedChain& chain : chains) {
    const bool known = std::any_of(legs.begin(), legs.end(),
                                   [&](const Leg& leg) { return leg.foot_link == chain.tip_link; });
    const std::vector<int> joints = JointsToBody(tree, tree.links[chain.tip_link].body);
    if (known || chain.from_link != 0 || joints.empty()) continue;
    const double tip = height(chain.tip_link);
    const double top = height(tree.joints[joints.front()].child_link);
    const bool hangs = root_on_floor ? top - tip > kLeastLeg * RobotSize(tree) : tip <= -tolerance;
    if (!hangs || tip > lowest + tolerance) continue;
    legs.push_back({chain.name, chain.tip_link, joints, T_root_link[chain.tip_link].linear()});
  }
  if (root_on_floor && legs.size() < 2) legs.clear();  // an arm that reaches down to the floor
  return legs;
}

double LegTop(const RobotTree& tree, const std::vector<int>& joints) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tree.coordinate_count());
  const int first = tree.joints[joints.front()].child_link;
  return std::max(0.0, LinkTransforms(tree, zero)[first].translation().z());
}

double StandingHeight(const RobotTree& tree, const std::vector<Leg>& legs) {
  if (legs.empty()) return 0.0;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tree.coordinate_count());
  const double foot = LinkTransforms(tree, zero)[legs.front().foot_link].translation().z();
  return LegTop(tree, legs.front().joints) - foot;
}

bool InLeg(const std::vector<Leg>& legs, int joint) {
  return std::any_of(legs.begin(), legs.end(), [&](const Leg& leg) {
    return std::find(leg.joints.begin(), leg.joints.end(), joint) != leg.joints.end();
  });
}

}  // namespace elastocal
