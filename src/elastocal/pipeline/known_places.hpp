// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// Reads measured positions (ReadMarkerPlaces) of markers that the recording has; empty without a
/// file. Markers that were knocked in the experiment are left out, because their position holds on
/// one side of the knock only; warnings say so. Throws InputError where the recording has none of
/// the markers.
std::vector<MarkerMeasurement> OpenMarkerPlaces(const std::filesystem::path& file,
                                                const Project& project, const Recording& recording,
                                                const std::vector<Knock>& knocks,
                                                std::vector<std::string>& warnings);

/// The estimate of the largest model with these positions as prior knowledge. A position that
/// contradicts the data and the other positions (JudgeMarkers) is left out and named. Where
/// positions scatter by 1.5 times their standard deviations or more, these are enlarged, and a
/// warning says so. `options.earlier` is in the end the prior knowledge that was used.
CalibrationResult CalibrateWithPlaces(std::vector<MarkerMeasurement> places,
                                      const RecordedModel& robot, const Recording& recording,
                                      CalibrationOptions& options,
                                      std::vector<std::string>& warnings);

}  // namespace elastocal
