// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Whether the error of the markers in a fit, m, is so much larger (three times) than the noise of
/// the cameras that its cause should be sought.
bool LeavesMoreThanCameras(const CalibrationResult& result, double left);

/// Root mean square distance of the markers from one robot whose markers have other positions in
/// each part, m; infinite where the equations do not suffice for that.
double ErrorWithOwnMarkers(const Project& project, const CalibrationResult& together,
                           Recording recording, const std::vector<PartOfRecording>& parts);

/// Whether parts of a recording differ by the positions of their markers, and not by their robots:
/// one robot with markers of its own in each part leaves hardly more (1.5 times) than separate
/// robots do. Both m.
bool AreMarkersApart(double by_markers, double apart);

/// Finds recordings that no single robot explains; nothing where one does, and for tables.
///
/// **Folders** that were given together are fitted each by itself. They are apart if this leaves
/// less than half of the error of `together` (rms distance of the markers), and at least 0.2 mm
/// less. Then one robot whose markers are displaced in each folder is also fitted. If that leaves
/// hardly more than the separate fits, markers were fixed anew between the folders; otherwise the
/// robots differ, or one robot was changed.
///
/// **Trials** of a folder: see FindTrialsApart.
///
/// `recording` is that of `together`. `most` is the error that another explanation leaves, m.
std::optional<PartsApart> FindRecordingsApart(const Project& project, const RecordedModel& robot,
                                              const Recording& recording,
                                              const CalibrationResult& together, double most);

}  // namespace elastocal
