// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// The inertia of a body that could exist and is near the given one, kg.m^2: the same if its
/// principal moments are not negative and none is larger than the sum of the others; otherwise
/// these are raised by the same amount until it is not. The principal axes stay.
Eigen::Matrix3d PhysicalInertia(const Eigen::Matrix3d& inertia);

/// What is wrong with the masses and inertias of a URDF, a sentence for each link: an inertia that
/// no body has or only one that is wider than the robot, a mass without inertia, no mass at all on
/// a body that a joint moves; and masses that together are in g, it seems. Only the simulator needs
/// inertias; statics need masses.
std::vector<std::string> InertiaWarnings(const RobotTree& tree);

}  // namespace elastocal
