// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// Warnings about what can be read in a project or its URDF but costs accuracy, a sentence each:
/// joints that cannot move; clusters whose markers lie on a line, close together, at similar
/// distances or far from their link; markers inside other parts; chains whose last joints move no
/// marker; inertias that no body has, and missing masses.
std::vector<std::string> ProjectWarnings(const Project& project);

}  // namespace elastocal
