// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Whether a fit that leaves this error of the markers, m, leaves so much more than cameras
/// displace markers by (three times) that it is worth looking for why.
bool LeavesMoreThanCameras(const CalibrationResult& result, double left);

/// Recordings that no one robot explains; nothing where one does, and for tables.
///
/// **Folders** that were given together. Each is fitted by itself. They are apart if that leaves
/// less than half of the error of `together` (rms distance of the markers), and 0.2 mm less. Then
/// one robot whose markers are all elsewhere in each folder is fitted as well: where it leaves
/// hardly more than the fits apart, markers were glued on anew between the folders; else the robots
/// differ, or one robot was changed.
///
/// **Trials** of a folder: see FindTrialsApart.
///
/// `recording`: that of `together`; `most`: what another explanation leaves, m.
std::optional<PartsApart> FindRecordingsApart(const Project& project, const RecordedModel& robot,
                                              const Recording& recording,
                                              const CalibrationResult& together, double most);

}  // namespace elastocal
