// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "elastocal/validation/error_table.hpp"

namespace elastocal {

/// Abbreviation of a kind of trial in Table 2 of the paper: SW sinusoidal motions, RP random
/// postures, RM repeatability motion.
const char* ErrorTableCase(TrialKind kind);

/// Table 2 of the paper as JSON, mm (docs/formats.md).
nlohmann::ordered_json MakeErrorTableJson(const ErrorTable& table);

}  // namespace elastocal
