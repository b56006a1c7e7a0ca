// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <pugixml.hpp>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// Name of the package in the folder's package.xml; empty without one.
std::string PackageName(const fs::path& folder) {
  pugi::xml_document manifest;
  if (!IsFile(folder / "package.xml") || !manifest.load_file((folder / "package.xml").c_str())) {
    return "";
  }
  return manifest.child("package").child_value("name");
}

/// Folders that may be the package, the most likely first.
std::vector<fs::path> FoldersOf(const std::string& package, const MeshPlaces& places) {
  std::vector<fs::path> folders;
  const auto given = places.packages.find(package);
  if (given != places.packages.end()) return {given->second};
  const auto take_if_named = [&](const fs::path& folder) {
    if (folder.filename() == package || PackageName(folder) == package) folders.push_back(folder);
  };
  for (const fs::path& root : places.roots) {
    folders.push_back(root / package);
    take_if_named(root);
  }
  if (places.urdf.empty()) return folders;
  std::error_code none;
  const fs::path urdf = fs::weakly_canonical(places.urdf, none);
  for (fs::path above = urdf.parent_path(); above.has_relative_path();
       above = above.parent_path()) {
    take_if_named(above);
    folders.push_back(above / package);
  }
  return folders;
}

/// The rest of a name after one of the prefixes; nothing where it has none of them.
std::optional<std::string> After(const std::string& name,
                                 std::initializer_list<std::string> prefixes) {
  for (const std::string& prefix : prefixes) {
    if (name.starts_with(prefix)) return name.substr(prefix.size());
  }
  return std::nullopt;
}

Eigen::Vector3d ToVector(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// A cell of a grid as one number.
std::int64_t CellOf(const Eigen::Vector3d& p, double size) {
  std::int64_t cell = 0;
  for (const double x : p) {
    constexpr std::int64_t kMost = 1 << 20;
    const double step = std::clamp(std::floor(x / size), -1.0 * kMost + 1.0, kMost - 1.0);
    cell = cell * 2 * kMost + static_cast<std::int64_t>(step) + kMost;
  }
  return cell;
}

}  // namespace

std::string PackageOf(const std::string& name) {
  const auto path = After(name, {"package://", "model://"});
  return path ? path->substr(0, path->find('/')) : "";
}

std::optional<fs::path> FindMesh(const std::string& name, const MeshPlaces& places) {
  if (const auto path = After(name, {"package://", "model://"})) {
    const std::size_t slash = path->find('/');
    if (slash == std::string::npos) return std::nullopt;
    for (const fs::path& folder : FoldersOf(path->substr(0, slash), places)) {
      if (const fs::path file = folder / path->substr(slash + 1); IsFile(file)) return file;
    }
    return std::nullopt;
  }
  const fs::path path = After(name, {"file://"}).value_or(name);
  // A text without a file has no neighbouring files.
  if (path.is_relative() && places.urdf.empty()) return std::nullopt;
  const fs::path file = places.urdf.parent_path() / path;
  return IsFile(file) ? std::optional(file) : std::nullopt;
}

std::vector<Triangle> ReadMesh(const fs::path& file, std::string& reason) {
  constexpr std::uintmax_t kMostBytes = 256U << 20;
  std::error_code none;
  if (fs::file_size(file, none) > kMostBytes) {
    reason = "it has more than 256 MiB";
    return {};
  }
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, 1);
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    reason = importer.GetErrorString();
    return {};
  }
  std::vector<Triangle> triangles;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines have no surface
      Triangle triangle;
      for (unsigned i = 0; i < 3; ++i) triangle[i] = ToVector(mesh.mVertices[face.mIndices[i]]);
      const bool finite = std::all_of(triangle.begin(), triangle.end(),
                                      [](const Eigen::Vector3d& p) { return p.allFinite(); });
      if (finite) triangles.push_back(triangle);
    }
  }
  if (triangles.empty()) reason = "it has no triangles";
  return triangles;
}

double VolumeOf(const std::vector<Triangle>& triangles) {
  double volume = 0.0;
  for (const Triangle& t : triangles) volume += t[0].dot(t[1].cross(t[2])) / 6.0;
  return std::abs(volume);
}

std::vector<Eigen::Vector3d> SurfacePoints(const std::vector<Triangle>& triangles, double spacing) {
  std::vector<Eigen::Vector3d> points;
  const auto steps = [&](double length) {
    return std::max(1, static_cast<int>(std::ceil(length / spacing)));
  };
  for (const Triangle& t : triangles) {
    // Finds the corner opposite to the shortest side, so that rows of points are short.
    std::size_t apex = 0;
    const auto opposite = [&](std::size_t i) { return (t[(i + 1) % 3] - t[(i + 2) % 3]).norm(); };
    for (std::size_t i = 1; i < 3; ++i) apex = opposite(i) < opposite(apex) ? i : apex;
    const Eigen::Vector3d one = t[(apex + 1) % 3] - t[apex], other = t[(apex + 2) % 3] - t[apex];
    const int rows = steps(std::max(one.norm(), other.norm()));
    for (int i = 0; i <= rows; ++i) {
      const double along = static_cast<double>(i) / rows;
      const int columns = steps(along * (one - other).norm());
      for (int j = 0; j <= (i == 0 ? 0 : columns); ++j) {
        const double across = static_cast<double>(j) / columns;
        points.emplace_back(t[apex] + along * ((1.0 - across) * one + across * other));
      }
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> ThinOut(const std::vector<Eigen::Vector3d>& points, std::size_t most) {
  if (points.size() <= most) return points;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  double extent = 0.0;
  for (const Eigen::Vector3d& p : points) extent = std::max(extent, (p - mean).norm());
  constexpr double kCoarser = 1.2;
  for (double size = 0.002 * extent;; size *= kCoarser) {
    std::unordered_map<std::int64_t, std::size_t> cells;
    std::vector<Eigen::Vector3d> kept;
    for (const Eigen::Vector3d& p : points) {
      const auto [cell, is_new] = cells.emplace(CellOf(p - mean, size), kept.size());
      if (is_new) kept.push_back(p);
      Eigen::Vector3d& known = kept[cell->second];
      if ((p - mean).squaredNorm() > (known - mean).squaredNorm()) known = p;
      if (kept.size() > most) break;
    }
    if (kept.size() <= most) return kept;
  }
}

}  // namespace elastocal
