// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// A project of TALOS's left arm with three markers on its hand.
inline constexpr const char* kTalosLeftArm = R"(
robot: {urdf: models/talos/talos.urdf}
chains: [{name: arm, tip: gripper_left_base_link}]
markers:
  single:
    - {name: A, link: arm_left_7_link, position_mm: [60, 10, -70]}
    - {name: B, link: arm_left_7_link, position_mm: [-50, 40, -60]}
    - {name: C, link: arm_left_7_link, position_mm: [10, -60, -90]}
)";

}  // namespace elastocal
