// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// A frame for the root of a robot whose root link does not look along x with z up.
struct RootAttitude {
  Transform T_new_root = Transform::Identity();  ///< of the root link in the new frame
  std::string link;                              ///< name of the new root link
};

/// The frame that has the robot's plane of symmetry as its x-z plane, x ahead and z up: as CAD
/// programs export it, a humanoid may look along y, or stand along x or y, or its root link may be
/// beside the plane. Sides in the names, feet or knees tell what is ahead. In doubt the root link
/// stays as it is:
/// - Limbs that are mirrored already keep it, unless names say that they are legs and they do not
///   reach the floor.
/// - An axis other than z points up only if names say of two limbs that they are legs, and all
///   limbs with such names then reach the floor.
/// - A robot without legs keeps it, unless names tell the sides of two arms of five joints or more,
///   and that another limb is a head.
std::optional<RootAttitude> FindRootAttitude(const RobotTree& tree, const RobotShapes& shapes,
                                             const Semantics& semantics);

/// The URDF with the new link as its root, joined to the old root by a fixed joint.
std::string AddRootLink(const std::string& urdf, const RobotTree& tree,
                        const RootAttitude& attitude);

}  // namespace elastocal
