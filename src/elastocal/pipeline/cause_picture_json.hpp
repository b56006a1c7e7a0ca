// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/pipeline/choose_causes.hpp"

namespace elastocal {

/// What causes look like, for programs and for the report's page (docs/formats.md): name, words,
/// what the displacement is of and against, units, points and curve, in the units of people.
nlohmann::ordered_json CausePicturesJson(const CauseReport& report);

}  // namespace elastocal
