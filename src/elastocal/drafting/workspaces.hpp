// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/drafting/rest_posture.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Where the tip of a leg may swing while the robot stands on the others: in a box around its place
/// in the posture of rest, turned by at most 60 degrees, above the floor. The box of a humanoid of
/// usual build is that of the paper's Fig. 2a, as shares of the height of the root link.
void SetLegWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest,
                     ChainSetup& setup);

/// Where the tip of another limb may be: in a box that holds nine tenths of what random postures
/// reach and, for an arm of a robot that stands on legs, is in front of it.
void SetArmWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest, bool on_legs,
                     ChainSetup& setup);

}  // namespace elastocal
