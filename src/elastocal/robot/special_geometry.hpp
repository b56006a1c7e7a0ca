#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Consecutive revolute joints whose axes have a relation on which inverse kinematics in closed
/// form relies.
struct SpecialGeometry {
  enum class Kind { kSphericalWrist, kParallelAxes };
  Kind kind;
  std::vector<int> joints;  ///< three for a wrist, two for parallel axes
};

/// Groups of joints in this description whose relation holds exactly (1 micrometre, 1 microradian).
std::vector<SpecialGeometry> FindSpecialGeometry(const RobotTree& tree);

/// Deviation of a group of joints in `tree` (the same joints, with other origins) from the
/// relation: the distance of the points where the axes of a wrist should meet, m, or the angle
/// between axes that should be parallel, rad.
double Deviation(const RobotTree& tree, const SpecialGeometry& group);

}  // namespace elastocal
