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

/// Places where the meshes named in a URDF are searched.
struct MeshPlaces {
  std::filesystem::path urdf;  ///< path of the URDF; empty: a text without a file
  std::map<std::string, std::filesystem::path> packages;  ///< folders of packages, by name
  std::vector<std::filesystem::path> roots;               ///< folders that contain packages
};

/// The file that a URDF means by `name`; nothing where there is none. `package://NAME/PATH` (and
/// Gazebo's `model://`) is PATH in the package's folder. That folder is, in this order: the one
/// given for NAME; the folder NAME in a root, or the root itself; a folder above the URDF that is
/// called NAME, has a package.xml for NAME, or contains a folder NAME. Other names are paths, with
/// or without `file://`, relative to the URDF.
std::optional<std::filesystem::path> FindMesh(const std::string& name, const MeshPlaces& places);

/// NAME in `package://NAME/PATH`; empty for other names.
std::string PackageOf(const std::string& name);

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Reads the triangles of a file (STL, OBJ, Collada and other formats of Assimp) in its own frame,
/// scaled by the unit that the file states. Collada's up axis is ignored, as RViz does. If the file
/// cannot be read, returns none, and `reason` says why.
std::vector<Triangle> ReadMesh(const std::filesystem::path& file, std::string& reason);

/// Volume inside a closed surface, m^3.
double VolumeOf(const std::vector<Triangle>& triangles);

/// Points on triangles at distances of at most `spacing`, corners included.
std::vector<Eigen::Vector3d> SurfacePoints(const std::vector<Triangle>& triangles, double spacing);

/// At most `most` of the points, evenly distributed; of close points the outermost is kept. All of
/// them if they are not more.
std::vector<Eigen::Vector3d> ThinOut(const std::vector<Eigen::Vector3d>& points, std::size_t most);

}  // namespace elastocal
