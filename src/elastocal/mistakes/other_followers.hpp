// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// A project in which joints follow others otherwise than described.
struct FollowerAlternative {
  std::string what;  ///< the mistake, in words
  Project project;
};

/// Coupled and mimic joints that follow the other way, or not at all: each by itself, and all that
/// follow the same one.
std::vector<FollowerAlternative> OtherFollowers(const Project& project);

}  // namespace elastocal
