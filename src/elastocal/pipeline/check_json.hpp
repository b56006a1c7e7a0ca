// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "elastocal/validation/moved_joints.hpp"

namespace elastocal {

/// By link: whether its markers are where they were.
nlohmann::ordered_json MarkersJson(const std::vector<LinkMarkers>& links);

/// `moved`, `suspects`, `or_markers`, `markers`, `earlier_sd_factor`, `not_told` and `joints`
/// (docs/formats.md).
void AddJointCheck(const JointCheck& check, nlohmann::ordered_json& json);

}  // namespace elastocal
