// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Reads a URDF. Joints may be fixed, revolute, continuous or prismatic, with `mimic`; floating and
/// planar ones part it, and the part with the most movable joints is the robot. Transmissions,
/// sensors, meshes and the like are passed over. What is odd but clear is read and named in the
/// tree's `warnings`: limits the wrong way round, several axes or one of another length than 1, an
/// inertia left out. Throws InputError naming file and line.
RobotTree ReadUrdf(const std::filesystem::path& file);

/// The same from text; `source` names it in messages.
RobotTree ParseUrdf(const std::string& text, const std::string& source);

}  // namespace elastocal
