// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// An inertia near the given one that a body can have, kg.m^2. The inertia stays as it is if no
/// principal moment is negative and none is larger than the sum of the other two. Otherwise the two
/// smaller moments are raised by the same amount until this holds. The principal axes stay.
Eigen::Matrix3d PhysicalInertia(const Eigen::Matrix3d& inertia);

/// What is wrong with the masses and inertias of a URDF, one sentence each:
/// - a link's inertia that no body can have, or (of a link above 0.01 kg) only a body wider than
///   the robot;
/// - a link with a mass but without inertia;
/// - parts that joints move whose mass is so large that it may not be in kg: more than 300 kg per
///   m^3 of a cube as wide as the robot;
/// - no mass on a body that a joint moves, nor on what near joints of this body move.
/// Only the simulator needs inertias; statics need masses.
std::vector<std::string> InertiaWarnings(const RobotTree& tree);

}  // namespace elastocal
