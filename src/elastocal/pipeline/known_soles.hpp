// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// What gives way below the markers of the feet, by all trials that were recorded. Where these do
/// not tell it, what the calibration `earlier` (a folder or file; empty: none) has of it. How feet
/// share the weight follows from `measured` as it is, mistakes undone.
std::vector<SoleSpring> KnownSoles(const Project& project, const CalibrationResult& result,
                                   const Measurements& measured,
                                   const std::filesystem::path& earlier);

}  // namespace elastocal
