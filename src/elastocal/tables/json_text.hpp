// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace elastocal {

/// The text of a JSON file: indented by two blanks. Bytes that are no UTF-8, as names from users'
/// files may have, become the replacement character.
template <typename Json>
std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// The same in one line, without the line's end.
template <typename Json>
std::string JsonLine(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace elastocal
