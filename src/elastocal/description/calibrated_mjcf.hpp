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

/// A user's MJCF with the geometry of a calibrated robot in it; not a byte else is changed.
///
/// Bodies are found by their joints (MjcfBodies), which have the names of the URDF's or those of
/// `joint_names`; links on fixed joints may be fused into their parents. A body that a
/// joint moves gets `pos` and `quat` of the calibrated URDF (`calibrated`, with the joints' zeros
/// left to the encoders), its joint `ref`, so that qpos is the position of the encoder: position in
/// the URDF = qpos + `encoder_offsets`. Elasticity has no place in it.
///
/// `nominal` is the tree of the URDF that was calibrated. Throws InputError naming file and line:
/// no MJCF; a joint is missing; a body that is more than 0.1 mm or 0.1 mrad
/// from where the nominal URDF has it, or on another parent; a joint about another axis, or not in
/// the origin of its body; an orientation given by anything but `quat`; global coordinates; with
/// springs, a keyframe of positions, or something that has the name of a new joint or body.
std::string MakeCalibratedMjcf(const std::string& mjcf, const std::string& source,
                               const RobotTree& nominal, const RobotTree& calibrated,
                               const std::map<std::string, double>& encoder_offsets,
                               const std::vector<SeriesSpring>& springs = {},
                               const MjcfJointNames& joint_names = {});

/// An MJCF of the folder `from` as it is to be in the folder `to`: what it says of folders and
/// files leads to the same files. Throws InputError where it includes files, whose own paths cannot
/// be changed.
std::string MoveMjcf(const std::string& mjcf, const std::string& source,
                     const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace elastocal
