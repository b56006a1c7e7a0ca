// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/drafting/rest_posture.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Sets the workspace of a leg's tip while the robot stands on the others: a box around its place
/// in the posture of rest, rotations of at most 60 degrees, above the floor. For a humanoid of
/// usual build the box is that of the paper's Fig. 2a, in shares of the height of the root link.
void SetLegWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest,
                     ChainSetup& setup);

/// Sets the workspace of another limb's tip: a box that contains nine tenths of the positions in
/// random postures and, for an arm of a robot on legs, lies in front of it.
void SetArmWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest, bool on_legs,
                     ChainSetup& setup);

}  // namespace elastocal
