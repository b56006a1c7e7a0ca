// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A joint whose position is a linear function of the positions of other joints, because of a
/// differential, rods or belts (a torso that stays upright, ankles driven in pairs).
struct Coupling {
  int joint = 0;
  std::vector<std::pair<int, double>> of;  ///< joints, and the factor of each
  double offset = 0.0;                     ///< rad or m
};

/// The tree with its joints coupled. A coupled joint has no entry of q of its own. Joints that it
/// follows and joints that follow it may be coupled as well. Throws InputError if a joint is
/// coupled twice, is a mimic joint, or follows itself through others.
RobotTree Couple(RobotTree tree, const std::vector<Coupling>& couplings);

/// Makes the joints of `to` follow the entries of q as those of `from` do. The two must be
/// descriptions of one robot, with the same joints in the same order.
void CopyDrives(const RobotTree& from, RobotTree& to);

}  // namespace elastocal
