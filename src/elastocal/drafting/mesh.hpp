// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Where the meshes that a URDF names are looked for.
struct MeshPlaces {
  std::filesystem::path urdf;  ///< the file; empty: a text without a place
  std::map<std::string, std::filesystem::path> packages;  ///< folders of packages by their names
  std::vector<std::filesystem::path> roots;               ///< folders that hold packages
};

/// The file that a URDF means by `name`, or nothing where there is none. `package://NAME/PATH` (and
/// Gazebo's `model://`) is PATH in the package's folder. In this order, that is the folder given
/// for NAME; what is called NAME in a root, or the root itself; a folder above the URDF that is
/// called NAME, has a package.xml for NAME, or holds a folder NAME. Other names are paths, with
/// `file://` or without, as seen from the URDF.
std::optional<std::filesystem::path> FindMesh(const std::string& name, const MeshPlaces& places);

/// NAME of `package://NAME/PATH`; empty for other names.
std::string PackageOf(const std::string& name);

using Triangle = std::array<Eigen::Vector3d, 3>;

/// The triangles of a file (STL, OBJ, Collada and what else Assimp reads) in its own frame, in the
/// unit that it says or else as they are. Collada's up axis is passed over, as RViz does. Where it
/// cannot be read, none, and `reason` says why.
std::vector<Triangle> ReadMesh(const std::filesystem::path& file, std::string& reason);

/// Volume inside a closed surface, m^3.
double VolumeOf(const std::vector<Triangle>& triangles);

/// Points on triangles that are not further than `spacing` from each other, their corners included.
std::vector<Eigen::Vector3d> SurfacePoints(const std::vector<Triangle>& triangles, double spacing);

/// At most `most` of the points, evenly spread: of those close to each other the outermost one. All
/// of them where they are not more.
std::vector<Eigen::Vector3d> ThinOut(const std::vector<Eigen::Vector3d>& points, std::size_t most);

}  // namespace elastocal
