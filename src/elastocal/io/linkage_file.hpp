// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// linkages.yaml: the rods with their estimated errors, as the section `linkages` of a project file
/// has them (docs/formats.md). The loops close on the nominal robot description; the joints'
/// positions that result belong to the calibrated one.
std::string MakeLinkagesYaml(const CalibrationResult& result);

}  // namespace elastocal
