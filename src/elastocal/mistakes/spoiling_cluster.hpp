// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Markers that are so far off in each posture that nothing is worth calibrating by them
/// (IsTooLoose), or that spoil what others tell: a fit without them leaves less than half of the
/// error of all other markers (ErrorAlone: no freedom of that fit is taken for its precision). In
/// words; empty: none.
std::vector<std::string> FindSpoilingCluster(const Project& project, const RecordedModel& robot,
                                             const Recording& recording,
                                             const CalibrationResult& result);

}  // namespace elastocal
