// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/drafting/semantics.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A branch of the robot: from where several branches part (or the root) to its end.
struct Limb {
  std::string name;
  int from_body = 0, tip_body = 0;
  int tip_link = 0;
  std::vector<int> joints;  ///< from the root link to the tip
  bool leg = false;         ///< it reaches the floor in the zero posture
  int mirror = -1;          ///< the limb on the other side, index; -1: none
};

struct Limbs {
  std::vector<Limb> limbs;  ///< in the order of the file
  std::vector<bool> tool;   ///< by body: fingers and wheels, which belong to no limb
};

/// Finds the limbs of a robot from its tree. Bodies that part in several short branches are hands:
/// what is beyond them are fingers. Bodies that one or two joints without an end carry are wheels,
/// and so are several ends of one body that turn without an end. Legs are limbs with a mirror image
/// whose ends are the lowest of the robot in the zero posture, well below the root link (below
/// their own first joint where the root link is a frame on the floor), and which begin not well
/// above it (arms of an upper body). Names are
/// those of the SRDF's groups, or of NameLimb: "left_leg", "right_arm", "head"; they can name files
/// and differ from each other. The tip is the link that the SRDF names, or the furthest one of the
/// last body.
Limbs FindLimbs(const RobotTree& tree, const RobotShapes& shapes, const Semantics& semantics);

}  // namespace elastocal
