#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A chain of the robot by its links, as a project names it.
struct NamedChain {
  std::string name;
  int from_link = 0, tip_link = 0;
};

/// A chain from the root link to a foot.
struct Leg {
  std::string chain;
  int foot_link = 0;        ///< the link that stands on the floor (the sole)
  std::vector<int> joints;  ///< from the waist to the foot
  Eigen::Matrix3d R_floor_foot = Eigen::Matrix3d::Identity();  ///< flat on a level floor, z up
};

/// The legs of a robot: chains from the root whose tips are, at the zero posture and with the root
/// link upright, within 2 % of the robot's size of the lowest tip of all, and below the root. A
/// foot that ends several chains counts once. A robot on a table (an arm) may have none.
std::vector<Leg> FindLegs(const RobotTree& tree, const std::vector<NamedChain>& chains);

/// Height of the root link above the soles at the zero posture, m; 0 without legs.
double StandingHeight(const RobotTree& tree, const std::vector<Leg>& legs);

/// Whether a joint belongs to a leg.
bool InLeg(const std::vector<Leg>& legs, int joint);

}  // namespace elastocal
