// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// Least height of a swinging foot between lifting and landing, m: 2.5 % of the leg's length. Feet
/// of a robot that is not calibrated were lower than planned by up to 2 % of it.
double LeastHeight(const StandingRobot& robot);

/// The feet that do not stand, indices of soles.
std::vector<int> SwingingFeet(const StandingRobot& robot, const std::vector<int>& standing);

/// Heights of the lowest points of a foot above the floor, m.
std::vector<double> HeightsOfFoot(const StandingRobot& robot, int foot, const PlacedPosture& pose);

/// What a way of the joints has to keep: distances of the robot's own parts, then heights of
/// swinging feet, scaled so that LeastHeight counts as the distance `wanted` of parts, m.
Eigen::VectorXd DistancesAboveFloor(const StandingRobot& robot, const std::vector<int>& standing,
                                    double wanted, const PlacedPosture& pose);

}  // namespace elastocal
