// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// The words of a name in small letters: "l", "knee" and "pitch" of "l_knee_pitch" and
/// "LKneePitch".
std::vector<std::string> WordsOf(const std::string& name);

/// The side of the robot that the names of a limb's joints and tip say: 1 left, -1 right, 0 none.
/// "left_knee", "LKneePitch", "l_knee", "knee_l" and, of four legs, "FL_calf" and "LF_KFE" are
/// left.
int SideByNames(const RobotTree& tree, const Limb& limb);

/// Whether the names of a limb's own joints or tip are those of an arm ("elbow", "wrist", "hand"),
/// and none is that of a leg. (Shoulders have four-legged robots as well.)
bool IsArmByNames(const RobotTree& tree, const Limb& limb);

/// "left_leg" and the like: the side by the names in the URDF where they say one, since a root link
/// may face any way, and by where the tip is in the zero posture otherwise.
std::string NameLimb(const RobotTree& tree, const std::vector<Limb>& limbs, const Limb& limb);

}  // namespace elastocal
