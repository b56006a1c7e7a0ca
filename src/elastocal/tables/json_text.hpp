// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace elastocal {

/// The text of a JSON file, indented by two spaces. Bytes that are not UTF-8, which names from
/// users' files may have, become the replacement character.
template <typename Json>
std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// The same text in one line, without a line end.
template <typename Json>
std::string JsonLine(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace elastocal
