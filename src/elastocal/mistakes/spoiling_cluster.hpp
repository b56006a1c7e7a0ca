// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Describes clusters that are so far off in each posture that no calibration by them is worthwhile
/// (IsTooLoose), or that spoil the others: a fit without them leaves less than half of the error of
/// all other markers (ErrorAlone, which corrects for the freedom of that fit). Empty: none.
std::vector<std::string> FindSpoilingCluster(const Project& project, const RecordedModel& robot,
                                             const Recording& recording,
                                             const CalibrationResult& result);

}  // namespace elastocal
