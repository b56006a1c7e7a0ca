// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Reads a URDF. Joints may be fixed, revolute, continuous or prismatic, with `mimic`. Floating and
/// planar joints divide it, and the part with the most movable joints is the robot
/// (ReadUrdfOutline). Transmissions, sensors, meshes and the like are passed over. Oddities with a
/// clear meaning are accepted and named in the tree's `warnings`: limits the wrong way round,
/// several axes, an axis whose length is not 1, an inertia that is left out. Throws InputError
/// naming file and line.
RobotTree ReadUrdf(const std::filesystem::path& file);

/// The same from text; `source` names it in messages.
RobotTree ParseUrdf(const std::string& text, const std::string& source);

}  // namespace elastocal
