// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// The measured places (ReadMarkerPlaces) of markers that the recording has; no file: none. Those
/// of clusters that were knocked in the experiment are left out, because they are of one side of
/// the knock; warnings say so. Throws InputError where the recording has none of the markers.
std::vector<MarkerMeasurement> OpenMarkerPlaces(const std::filesystem::path& file,
                                                const Project& project, const Recording& recording,
                                                const std::vector<Knock>& knocks,
                                                std::vector<std::string>& warnings);

/// The estimate of the largest model with these places known. A place that contradicts the data and
/// the other places (JudgeMarkers) is left out and named; where places scatter by more than their
/// standard deviations say, these are made larger, and a warning says so. `options.earlier` is in
/// the end what was known.
CalibrationResult CalibrateWithPlaces(std::vector<MarkerMeasurement> places,
                                      const RecordedModel& robot, const Recording& recording,
                                      CalibrationOptions& options,
                                      std::vector<std::string>& warnings);

}  // namespace elastocal
