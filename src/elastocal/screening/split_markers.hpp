// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What was seen of a marker in the postures `there` (by posture, whether it is one) goes to a new
/// marker of this name, the last one.
void SplitMarker(int marker, const std::string& name, const std::vector<char>& there,
                 Recording& recording);

/// The same of several markers, and in the model: each new one, with its name in `names`, is on the
/// same link and at the same nominal place.
void SplitMarkersOf(const std::vector<int>& markers, const std::vector<std::string>& names,
                    const std::vector<char>& there, ErrorModel& model, Recording& recording);

}  // namespace elastocal
