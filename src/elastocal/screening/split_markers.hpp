// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Moves the observations of a marker in the postures marked in `there` (one entry a posture) to a
/// new marker with this name, which is the last one.
void SplitMarker(int marker, const std::string& name, const std::vector<char>& there,
                 Recording& recording);

/// As SplitMarker for several markers, also in the model. Each new marker (name in `names`) is on
/// the same link with the same nominal position.
void SplitMarkersOf(const std::vector<int>& markers, const std::vector<std::string>& names,
                    const std::vector<char>& there, ErrorModel& model, Recording& recording);

}  // namespace elastocal
