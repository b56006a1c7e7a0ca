// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Reads a table of measured marker places (docs/formats.md). Throws InputError naming file and
/// line: an unknown marker, or one that comes twice; a link that is not on the marker's body; what
/// is no number, or out of bounds; no rows; places in m.
std::vector<MarkerMeasurement> ReadMarkerPlaces(const std::filesystem::path& file,
                                                const Project& project);

/// Warnings, one for each table `marker_places.csv` that lies in the folder of a recording (a
/// folder or a file), for a command that was given no table: it would not be used.
std::vector<std::string> WarnOfIdleMarkerPlaces(
    const std::vector<std::filesystem::path>& recordings);

/// Such a table as text, each place in the frame of the marker's link.
std::string FormatMarkerPlaces(const std::vector<MarkerMeasurement>& places);

}  // namespace elastocal
