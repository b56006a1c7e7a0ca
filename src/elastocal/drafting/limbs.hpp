// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/drafting/semantics.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A branch of the robot, from the body where several branches part (or the root) to its end.
struct Limb {
  std::string name;
  int from_body = 0, tip_body = 0;
  int tip_link = 0;
  std::vector<int> joints;  ///< from the root link to the tip
  bool leg = false;         ///< it reaches the floor in the zero posture
  int mirror = -1;          ///< index of the mirrored limb; -1: none
};

struct Limbs {
  std::vector<Limb> limbs;  ///< in the order of the URDF
  std::vector<bool> tool;   ///< by body: part of a hand, a toe or a wheel, of no limb
  std::set<int> toes;       ///< bodies beyond the feet of legs
};

/// Finds the limbs of a robot from its tree. A body that parts into several short branches is a
/// hand, and the branches are fingers. A body carried by one or two joints without limits is a
/// wheel, and so are several ends of one body that turn without limits.
///
/// Legs are limbs with a mirror image whose ends are the lowest of the robot in the zero posture,
/// well below the root link (or below their own first joint where the root link is a frame on the
/// floor), and that do not begin well above it (as arms of an upper body do). A leg ends with the
/// foot; toes that a joint moves belong to none (those of both legs of a pair, or of neither).
/// Names are those of the SRDF's groups, or given by NameLimb: "left_leg", "right_arm", "head";
/// they are unique and valid as names of files. The tip is the link that the SRDF names, or the
/// furthest link of the last body.
Limbs FindLimbs(const RobotTree& tree, const RobotShapes& shapes, const Semantics& semantics);

/// Whether two limbs look like mirror images in the plane normal . p = offset (unit normal, in the
/// root link's frame): they begin on one body and have the same number and types of joints, each
/// within 2 % of the longest branch of the other's reflected position, and one at least aside. The
/// joints of a common trunk do not count. `T_root_body`: poses of the bodies (zero posture).
bool LookAlike(const RobotTree& tree, const std::vector<Transform>& T_root_body, const Limb& a,
               const Limb& b, const Eigen::Vector3d& normal, double offset);

}  // namespace elastocal
