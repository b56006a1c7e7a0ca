// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/pipeline/choose_causes.hpp"

namespace elastocal {

/// Pictures of causes as JSON, for programs and for the report's page (docs/formats.md): name,
/// description, displaced quantity and variable, units, points and curve, in the units that are
/// shown to users.
nlohmann::ordered_json CausePicturesJson(const CauseReport& report);

}  // namespace elastocal
