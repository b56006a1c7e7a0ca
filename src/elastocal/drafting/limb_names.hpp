// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// The words of a name in lower case: "l", "knee" and "pitch" for "l_knee_pitch" and "LKneePitch".
std::vector<std::string> WordsOf(const std::string& name);

/// Whether the name is that of a sole.
bool NamedSole(const std::string& name);

/// Side of the robot according to the names of a limb's joints and tip: 1 left, -1 right, 0
/// unknown. "left_knee", "LKneePitch", "l_knee", "knee_l" and, on four legs, "FL_calf" and "LF_KFE"
/// are left.
int SideByNames(const RobotTree& tree, const Limb& limb);

/// Whether the names of a limb's own joints or tip are those of a leg ("hip", "knee", "foot").
bool IsLegByNames(const RobotTree& tree, const Limb& limb);

/// Whether the names of a limb's own joints or tip are those of an arm ("elbow", "wrist", "hand")
/// and none is that of a leg. ("shoulder" does not count: legs of four-legged robots have shoulders
/// as well.)
bool IsArmByNames(const RobotTree& tree, const Limb& limb);

/// Whether the names of a limb's own joints or tip are those of a head or a neck.
bool IsHeadByNames(const RobotTree& tree, const Limb& limb);

/// Name of a limb, such as "left_leg". The side follows from the names in the URDF if they tell it,
/// because a root link may face any direction; otherwise from the position of the tip in the zero
/// posture.
std::string NameLimb(const RobotTree& tree, const std::vector<Limb>& limbs, const Limb& limb);

}  // namespace elastocal
