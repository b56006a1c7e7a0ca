// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal {

/// A number, or null for infinity and NaN, which JSON does not have.
nlohmann::ordered_json Finite(double value);

/// How well the ends of limbs are known in the frame of the root link: `frames` of summary.json.
nlohmann::ordered_json FramesJson(const CalibrationRun& run);

/// How well the project has the places of markers (`nominal_places`); null where it is not told.
nlohmann::ordered_json NominalPlacesJson(const CalibrationResult& result);

/// How stiff the legs are at the waist: `legs` of summary.json. Null for a robot without legs.
nlohmann::ordered_json LegsJson(const CalibrationRun& run);

/// What gives way below the markers of the feet (`soles` of summary.json).
nlohmann::ordered_json SolesJson(const CalibrationRun& run);

}  // namespace elastocal
