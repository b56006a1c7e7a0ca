// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/json_reader.hpp"

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json ParseJsonObject(const std::string& source, const std::string& text) {
  // Values are copied and written by recursion, so that deep nesting would exhaust the stack.
  constexpr int kDeepest = 100;
  const auto check_depth = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth <= kDeepest) return true;
    throw InputError(source + ": nested more than 100 levels deep");
  };
  Json json;
  try {
    json = Json::parse(text, check_depth);
  } catch (const Json::exception& error) {
    throw InputError(source + ": is no JSON: " + error.what());
  }
  if (json.is_object()) return json;
  throw InputError(source + ": found JSON of the type " + json.type_name() +
                   "; an object was expected");
}

}  // namespace elastocal
