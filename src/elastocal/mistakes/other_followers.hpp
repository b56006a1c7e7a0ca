// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// A project in which joints follow others differently.
struct FollowerAlternative {
  std::string what;  ///< the mistake, in words
  Project project;
};

/// Projects in which coupled or mimic joints follow with the opposite sign, or not at all: each by
/// itself, and all that follow the same joint.
std::vector<FollowerAlternative> OtherFollowers(const Project& project);

}  // namespace elastocal
