#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace elastocal {

/// Throws InputError, beginning with `place`, for a column that means nothing: with the nearest
/// known one and where columns to be passed over are listed, or that a header row was expected
/// where it is a number.
[[noreturn]] void FailUnknownColumn(const std::string& column, const std::string& place,
                                    const std::vector<std::string>& known,
                                    const std::filesystem::path& project_file);

/// The names of a map.
template <typename Value>
std::vector<std::string> KeysOf(const std::map<std::string, Value>& map) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  return keys;
}

}  // namespace elastocal
