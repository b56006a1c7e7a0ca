#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace elastocal {

/// Contents of a file. Throws InputError when it cannot be read or is larger than 256 MiB.
std::string ReadFile(const std::filesystem::path& file);

/// Writes a file whole or not at all: to a temporary name beside it, then renamed. Creates the
/// folder. Follows symbolic links. Devices, pipes and the like are written to, not replaced; "-" is
/// standard output. Throws InputError naming the file as it was given.
void WriteFile(const std::filesystem::path& file, const std::string& contents);

/// Writes several files (names and contents), all or none as far as a file system allows: nothing
/// gets its name before everything is written. On failure the folders created are removed again.
void WriteFiles(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Whether two paths lead to one file; false where one of them leads to none.
bool SameFile(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace elastocal
