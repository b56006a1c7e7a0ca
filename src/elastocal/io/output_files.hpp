#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace elastocal {

/// Contents of a file. Throws InputError when it cannot be read or is larger than 256 MiB.
std::string ReadFile(const std::filesystem::path& file);

/// Writes one file, or several, by an OutputSet: all or none. Creates folders.
void WriteFile(const std::filesystem::path& file, const std::string& contents);
void WriteFiles(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Whether two paths lead to one file; false where one of them leads to none.
bool SameFile(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace elastocal
