// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Consecutive revolute joints whose axes are parallel or meet in one point. Inverse kinematics in
/// closed form relies on such relations.
struct SpecialGeometry {
  enum class Kind { kSphericalWrist, kParallelAxes };
  Kind kind;
  std::vector<int> joints;  ///< three for a wrist, two for parallel axes
};

/// Groups of joints in this description whose relation holds exactly (1 micrometre, 1 microradian).
std::vector<SpecialGeometry> FindSpecialGeometry(const RobotTree& tree);

/// Groups of joints whose relation holds nearly, but not exactly: axes less than a degree from
/// parallel, axes of a wrist that meet within 5 mm. A description says so after a calibration, or
/// where numbers were rounded; no robot is meant to be so.
std::vector<SpecialGeometry> FindNearlySpecialGeometry(const RobotTree& tree);

/// Distance between the parallel axes of two joints in the zero posture, m; 0 if they coincide.
double AxisDistance(const RobotTree& tree, int first, int second);

/// Deviation of a group of joints in `tree` (the same joints, with other origins) from the
/// relation: the distance of the points where the axes of a wrist should meet, m, or the angle
/// between axes that should be parallel, rad.
double Deviation(const RobotTree& tree, const SpecialGeometry& group);

}  // namespace elastocal
