#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// Contents of a file. Throws InputError when it cannot be read or is larger than 256 MiB.
std::string ReadFile(const std::filesystem::path& file);

/// Writes a file whole or not at all: to a temporary name beside it, then renamed. Creates the
/// folder. Throws InputError when that fails.
void WriteFile(const std::filesystem::path& file, const std::string& contents);

}  // namespace elastocal
