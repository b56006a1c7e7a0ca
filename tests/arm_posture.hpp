// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// A posture file of TALOS with one posture of the left arm, to which more can be appended.
inline constexpr const char* kPostureOfArm = R"(
robot: talos
chains:
  - name: arm_left
    support: [left_sole_link, right_sole_link]
    postures:
      - {arm_left_1_joint: -0.4, arm_left_2_joint: 0.6, arm_left_4_joint: -1.2}
)";

}  // namespace elastocal
