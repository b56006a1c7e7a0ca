// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/swinging_feet.hpp"

#include <algorithm>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

double LeastHeight(const StandingRobot& robot) { return 0.025 * robot.leg_length; }

std::vector<int> SwingingFeet(const StandingRobot& robot, const std::vector<int>& standing) {
  std::vector<int> swinging;
  for (const int foot : robot.AllFeet()) {
    if (std::find(standing.begin(), standing.end(), foot) != standing.end()) continue;
    swinging.push_back(foot);
  }
  return swinging;
}

std::vector<double> HeightsOfFoot(const StandingRobot& robot, int foot, const PlacedPosture& pose) {
  return HeightsOverFloor(robot.soles[Size(foot)],
                          pose.T_world_root * robot.legs[Size(foot)].SolePose(pose.q));
}

Eigen::VectorXd DistancesAboveFloor(const StandingRobot& robot, const std::vector<int>& standing,
                                    double wanted, const PlacedPosture& pose) {
  const Eigen::VectorXd apart = robot.clearances ? robot.clearances(pose.q) : Eigen::VectorXd();
  std::vector<double> all(apart.begin(), apart.end());
  for (const int foot : SwingingFeet(robot, standing)) {
    for (const double height : HeightsOfFoot(robot, foot, pose)) {
      all.push_back(wanted / LeastHeight(robot) * height);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

}  // namespace elastocal
