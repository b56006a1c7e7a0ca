#pragma once

#include <filesystem>
#include <string>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Reads a URDF. Joints may be fixed, revolute, continuous or prismatic, with `mimic`; a floating
/// joint at the root is left out (its child becomes the root). Transmissions, sensors, meshes and
/// the like are passed over. Throws InputError naming file and line.
RobotTree ReadUrdf(const std::filesystem::path& file);

/// The same from text; `source` names it in messages.
RobotTree ParseUrdf(const std::string& text, const std::string& source);

}  // namespace elastocal
