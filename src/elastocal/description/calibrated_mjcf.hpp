// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elastocal/description/mjcf_bodies.hpp"
#include "elastocal/description/series_springs.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Puts the geometry of a calibrated robot into a user's MJCF; every other byte stays as it is.
///
/// Bodies are found by their joints (MjcfBodies), which have the names of the URDF's joints or
/// those of `joint_names`; links on fixed joints may be fused into their parents. A body that a
/// joint moves gets `pos` and `quat` of the calibrated URDF (`calibrated`, whose joint zeros are
/// left to the encoders). Its joint gets `ref`, so that qpos is the position of the encoder:
/// position in the URDF = qpos + `encoder_offsets`. Each of `springs` becomes an elastic joint in
/// series with its motor; without them, the model is rigid.
///
/// `nominal` is the tree of the URDF that was calibrated. Throws InputError naming file and line:
/// - no MJCF; a joint is missing; global coordinates;
/// - a body that is more than 0.1 mm or 0.1 mrad from where the nominal URDF has it, or on another
///   parent; an orientation that is not given by `quat`;
/// - a joint about another axis, or not in the origin of its body;
/// - angles of an unknown unit: no `angle` of a `compiler` and no joint with the URDF's limits;
/// - with springs, a keyframe of positions, or something with the name of a new joint or body.
std::string MakeCalibratedMjcf(const std::string& mjcf, const std::string& source,
                               const RobotTree& nominal, const RobotTree& calibrated,
                               const std::map<std::string, double>& encoder_offsets,
                               const std::vector<SeriesSpring>& springs = {},
                               const MjcfJointNames& joint_names = {});

/// Changes the paths in an MJCF of the folder `from` so that they lead to the same files when it is
/// in the folder `to`. Throws InputError if it includes other MJCF files, because the paths in
/// these cannot be changed.
std::string MoveMjcf(const std::string& mjcf, const std::string& source,
                     const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace elastocal
