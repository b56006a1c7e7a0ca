// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A chain of the robot between two links, with its name in the project.
struct NamedChain {
  std::string name;
  int from_link = 0, tip_link = 0;
};

/// A chain from the root link to a foot.
struct Leg {
  std::string chain;
  int foot_link = 0;        ///< the link that stands on the floor (the sole)
  std::vector<int> joints;  ///< from the waist to the foot
  Eigen::Matrix3d R_floor_foot =
      Eigen::Matrix3d::Identity();  ///< attitude of the foot flat on a level floor, z up
};

/// Finds the legs of a robot. Heights are those in the zero posture with the root link upright. A
/// leg is a chain from the root link whose tip is at least 2 % of the robot's size (RobotSize)
/// below the root link and at most 2 % above the lowest tip of all chains. If the root link is
/// itself within 2 % of the lowest tip (a frame on the floor), legs are chains whose first joint is
/// more than 10 % of the size above their tip, and there must be two or more of them. If several
/// chains end in one foot, the first is taken. A robot may have no legs (an arm on a table).
std::vector<Leg> FindLegs(const RobotTree& tree, const std::vector<NamedChain>& chains);

/// Height of a leg's first joint above the root link in the zero posture, m; 0 if it is below the
/// root link. `joints` lead from the root link to the foot.
double LegTop(const RobotTree& tree, const std::vector<int>& joints);

/// Height of the root link, or of the first joint of the first leg if that is higher, above the
/// foot of the first leg in the zero posture, m; 0 without legs.
double StandingHeight(const RobotTree& tree, const std::vector<Leg>& legs);

/// Whether a joint belongs to a leg.
bool InLeg(const std::vector<Leg>& legs, int joint);

}  // namespace elastocal
