// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// A file of this repository, by its path from the top folder.
std::filesystem::path SourceFile(const std::string& path);

/// A recording or robot description that is not part of this repository: `data/...` or `robots/...`
/// of a folder `shared` beside it, or beside the data folder that the environment variable
/// ELASTOCAL_SHARED_DATA names. Tests that need one are skipped where it does not exist.
std::filesystem::path SharedFile(const std::string& path);

}  // namespace elastocal
