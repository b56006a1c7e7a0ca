// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/robot_views.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// The movable joints between the ends of a chain, by name.
ChainView MakeChainView(const Chain& chain, const RobotTree& tree) {
  ChainView view{chain.name, {}};
  const std::vector<int> below = JointsToBody(tree, tree.links[chain.from_link].body);
  for (const int joint : JointsToBody(tree, tree.links[chain.tip_link].body)) {
    if (std::find(below.begin(), below.end(), joint) == below.end()) {
      view.joints.push_back(tree.joints[joint].name);
    }
  }
  return view;
}

/// Path of a mesh of a URDF: relative to the URDF or, for `package://NAME/rest`, below the folder
/// NAME that contains the URDF.
fs::path MeshPath(const std::string& name, const fs::path& urdf) {
  const std::string scheme = "package://";
  if (!name.starts_with(scheme)) return urdf.parent_path() / name;
  const fs::path rest = name.substr(scheme.size());
  for (fs::path folder = fs::absolute(urdf).parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (folder.filename() == *rest.begin()) return folder.parent_path() / rest;
  }
  return {};
}

/// The existing STL files that the URDF names, by the names in the URDF.
std::map<std::string, std::string> FindMeshes(const std::string& urdf, const fs::path& file,
                                              std::vector<std::string>& warnings) {
  constexpr std::size_t kMostBytes = 2000000;
  const std::string before = "filename=\"";
  std::map<std::string, std::string> meshes;
  std::set<std::string> tried;
  std::size_t bytes = 0;
  for (std::size_t at = urdf.find(before); at != std::string::npos;
       at = urdf.find(before, at + 1)) {
    const std::size_t begin = at + before.size();
    const std::string name = urdf.substr(begin, urdf.find('"', begin) - begin);
    if (!(name.ends_with(".stl") || name.ends_with(".STL")) || !tried.insert(name).second) continue;
    const fs::path mesh = MeshPath(name, file);
    std::error_code error;
    if (mesh.empty() || !fs::is_regular_file(mesh, error)) continue;
    const std::size_t size = fs::file_size(mesh, error);
    if (error || bytes + size > kMostBytes) continue;
    try {
      meshes[name] = ReadFile(mesh);
      bytes += size;
    } catch (const InputError& unreadable) {
      warnings.push_back(std::string("the 3-D view lacks a mesh: ") + unreadable.what());
    }
  }
  return meshes;
}

}  // namespace

std::vector<ClusterView> MakeClusterViews(const Project& project) {
  std::vector<ClusterView> views;
  std::set<int> in_cluster;
  for (const MarkerCluster& cluster : project.clusters) {
    ClusterView view{cluster.name, project.tree.links[cluster.link].name, {}};
    for (const int marker : cluster.markers) {
      view.markers.push_back(project.markers[marker].name);
      in_cluster.insert(marker);
    }
    views.push_back(std::move(view));
  }
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    if (in_cluster.contains(static_cast<int>(m))) continue;
    const Marker& marker = project.markers[m];
    views.push_back({marker.name, project.tree.links[marker.link].name, {marker.name}});
  }
  return views;
}

RobotView MakeRobotView(const Project& project, std::vector<std::string>& warnings) {
  RobotView view{project.tree,        ReadFile(project.urdf), {}, {}, {}, {},
                 project.motion.rest, project.markers,        {}};
  view.meshes = FindMeshes(view.urdf, project.urdf, warnings);
  for (const Chain& chain : project.chains) {
    view.chains.push_back(MakeChainView(chain, project.tree));
  }
  for (const CollisionSphere& sphere : project.motion.spheres) {
    view.spheres.push_back(
        {project.tree.links[sphere.link].name, sphere.p_link_centre, sphere.radius});
  }
  for (const ChainSetup& setup : project.motion.chains) {
    if (!setup.box) continue;
    view.workspaces.push_back(
        {setup.name, project.tree.links[0].name, setup.box->lower, setup.box->upper});
  }
  for (const Sole& sole : project.soles) {
    const Eigen::Vector2d ball = Eigen::Vector2d::Constant(sole.height());
    view.soles.push_back(
        {project.tree.links[sole.link].name, sole.lower - ball, sole.upper + ball});
  }
  return view;
}

}  // namespace elastocal
