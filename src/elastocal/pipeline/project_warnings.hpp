// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// What in a project or its URDF can be read but will cost something, a sentence each: joints that
/// cannot move; clusters whose markers are in a line, hardly apart, at like distances or far from
/// their link; chains whose last joints move no marker; inertias that no body has, and masses that
/// are missing.
std::vector<std::string> ProjectWarnings(const Project& project);

}  // namespace elastocal
