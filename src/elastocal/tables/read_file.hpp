// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// Type of the file to which a path leads. Throws InputError if it cannot be told: a loop of links,
/// a folder that may not be entered, a name that is too long.
std::filesystem::file_type FileTypeOf(const std::filesystem::path& path);

/// Contents of a regular file, which is opened once. Throws InputError naming it: there is none, it
/// is a folder, a device or a pipe, it cannot be read, or it is larger than 256 MiB.
std::string ReadFile(const std::filesystem::path& file);

}  // namespace elastocal
