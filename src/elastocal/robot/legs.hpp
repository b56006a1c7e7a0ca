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

/// Finds the legs of a robot: the chains from the root whose tips are below the root and, in the
/// zero posture with the root link upright, not more than 2 % of the robot's size above the lowest
/// tip. Where the root link is a frame on the floor, as low as the lowest tip, legs are two chains
/// or more that begin well above it. A foot at the end of several chains counts once. A robot on a
/// table (an arm) may have no legs.
std::vector<Leg> FindLegs(const RobotTree& tree, const std::vector<NamedChain>& chains);

/// How high a leg begins in the zero posture, m above the root link: its first joint, or the root
/// link itself where that is higher (0). `joints`: from the root link to the foot.
double LegTop(const RobotTree& tree, const std::vector<int>& joints);

/// Height of the root link, or of the first joint of a leg where that is higher, above the soles at
/// the zero posture, m; 0 without legs.
double StandingHeight(const RobotTree& tree, const std::vector<Leg>& legs);

/// Whether a joint belongs to a leg.
bool InLeg(const std::vector<Leg>& legs, int joint);

}  // namespace elastocal
