// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Compliance of the soles below the markers of the feet, by all trials that were recorded; where
/// these do not tell it, by the calibration `earlier` (a folder or file; empty: none). The
/// distribution of weight between the feet follows from `measured`, with mistakes corrected.
std::vector<SoleSpring> KnownSoles(const Project& project, const CalibrationResult& result,
                                   const Measurements& measured,
                                   const std::filesystem::path& earlier);

}  // namespace elastocal
