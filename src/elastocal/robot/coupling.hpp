// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A joint whose position is a linear function of those of other joints: by a differential, by rods
/// or belts (a torso that stays upright, ankles driven in pairs).
struct Coupling {
  int joint = 0;
  std::vector<std::pair<int, double>> of;  ///< joints, and the factor of each
  double offset = 0.0;                     ///< rad or m
};

/// The tree with its joints coupled: a coupled joint loses its entry of q. What it follows, and
/// what follows it, may be coupled itself. Throws InputError where a joint is coupled twice, is a
/// mimic joint, or follows itself in the end.
RobotTree Couple(RobotTree tree, const std::vector<Coupling>& couplings);

/// Lets the joints of `to` follow entries of q as those of `from` do: two descriptions of one
/// robot, with the same joints in the same order.
void CopyDrives(const RobotTree& from, RobotTree& to);

}  // namespace elastocal
