// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace elastocal {

/// A URDF of the folder `from`, as it finds its meshes and textures from the folder `to`: relative
/// file names lead back into `from`. Names with `package://`, `file://` and the like, absolute
/// names and macros stay, and so does every other byte. A name stays as well if no relative path
/// leads back.
std::string MoveUrdf(const std::string& urdf, const std::string& source,
                     const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace elastocal
