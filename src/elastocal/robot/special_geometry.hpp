#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Consecutive revolute joints whose axes stand in a relation that closed-form inverse kinematics
/// relies on.
struct SpecialGeometry {
  enum class Kind { kSphericalWrist, kParallelAxes };
  Kind kind;
  std::vector<int> joints;  ///< three for a wrist, two for parallel axes
};

/// Groups that hold exactly (1 micrometre, 1 microradian) in this description.
std::vector<SpecialGeometry> FindSpecialGeometry(const RobotTree& tree);

/// How far a group of `tree` (the same joints, other origins) is from the relation: m between the
/// points where a wrist's axes should meet, or rad between axes that should be parallel.
double Deviation(const RobotTree& tree, const SpecialGeometry& group);

}  // namespace elastocal
