// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// For each chain: the table with all joints of its limb reversed in sign. For each two chains with
/// the same number of joints: the table with those of the two limbs exchanged, joint by joint from
/// the body outwards. A joint that also carries other chains belongs to no limb.
std::vector<LogAlternative> WholeLimbs(const Recording& recording, const Project& project);

}  // namespace elastocal
