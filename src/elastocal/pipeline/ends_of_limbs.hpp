// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// Links at the ends of the project's chains (hands, feet, a camera) that joints move, each once,
/// in the order of the chains.
std::vector<int> EndsOfLimbs(const Project& project);

}  // namespace elastocal
