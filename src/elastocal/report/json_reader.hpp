// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace elastocal {

/// Parses the JSON object in the text of a file; `source` names it in messages. All JSON is read by
/// this function. Throws InputError for text that is no JSON, numbers that no double holds, nesting
/// beyond 100 levels, and another value than an object.
nlohmann::ordered_json ParseJsonObject(const std::string& source, const std::string& text);

}  // namespace elastocal
