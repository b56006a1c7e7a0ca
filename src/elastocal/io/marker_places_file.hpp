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

/// Such a table as text, each place in the frame of the marker's link.
std::string FormatMarkerPlaces(const std::vector<MarkerMeasurement>& places);

}  // namespace elastocal
