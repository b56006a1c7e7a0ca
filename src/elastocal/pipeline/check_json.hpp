// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/validation/moved_joints.hpp"

namespace elastocal {

/// `moved`, `suspects`, `not_told` and `joints` (docs/formats.md).
void AddJointCheck(const JointCheck& check, nlohmann::ordered_json& json);

}  // namespace elastocal
