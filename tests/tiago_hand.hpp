// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// The part of a project file that is about the recordings of a TIAGo in ../shared/data: its arm
/// and the four markers on its hand at rough positions.
inline constexpr const char* kTiagoHand = R"(
chains: [{name: arm, tip: arm_7_link}]
markers:
  single:
    - {name: M1, link: arm_7_link, position_mm: [0, 70, 130]}
    - {name: M2, link: arm_7_link, position_mm: [0, -90, 145]}
    - {name: M3, link: arm_7_link, position_mm: [0, -60, 235]}
    - {name: M4, link: arm_7_link, position_mm: [0, 50, 235]}
recording:
  ignore: [shipped_row, t_start_robot, t_end_robot, marker_std_mm]
  columns: {markers: {M1: [x1, y1, z1], M2: [x2, y2, z2], M3: [x3, y3, z3], M4: [x4, y4, z4]}}
)";

}  // namespace elastocal
