// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// The table with all joints of a limb of the opposite sign, for each chain; and with those of two
/// limbs exchanged, joint by joint from the body outwards, for each two chains with as many joints.
/// A joint that carries other chains as well belongs to no limb.
std::vector<LogAlternative> WholeLimbs(const Recording& recording, const Project& project);

}  // namespace elastocal
