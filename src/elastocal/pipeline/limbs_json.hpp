// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/pipeline/calibrate_experiment.hpp"

namespace elastocal {

/// A number, or null for infinity and NaN, which JSON does not have.
nlohmann::ordered_json Finite(double value);

/// Expected errors of the ends of limbs in the frame of the root link: `frames` of summary.json.
nlohmann::ordered_json FramesJson(const CalibrationRun& run);

/// How well the project knows its marker positions (`nominal_places`); null where the recording
/// does not tell it.
nlohmann::ordered_json NominalPlacesJson(const CalibrationResult& result);

/// Stiffness of the legs at the waist: `legs` of summary.json. Null for a robot without legs.
nlohmann::ordered_json LegsJson(const CalibrationRun& run);

/// Compliance below the markers of the feet (`soles` of summary.json).
nlohmann::ordered_json SolesJson(const CalibrationRun& run);

}  // namespace elastocal
