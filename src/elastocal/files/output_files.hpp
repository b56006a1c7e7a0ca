// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/tables/read_file.hpp"

namespace elastocal {

/// Writes one file, or several, by an OutputSet: all or none. Creates folders.
void WriteFile(const std::filesystem::path& file, const std::string& contents);
void WriteFiles(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// Whether two paths lead to one file; false if one of them leads to no file.
bool SameFile(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace elastocal
