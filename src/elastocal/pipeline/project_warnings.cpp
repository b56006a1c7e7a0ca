// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/project_warnings.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/physical_inertia.hpp"

namespace elastocal {
namespace {

/// The worst fault of three markers of a cluster, as text; empty where they are well placed.
std::string TriangleFault(const std::array<Eigen::Vector3d, 3>& p) {
  constexpr double kHardlyApart = 0.010, kAlike = 0.002, kFlat = 0.05;  // m, m, share
  std::array<double, 3> sides = {(p[0] - p[1]).norm(), (p[1] - p[2]).norm(), (p[2] - p[0]).norm()};
  std::sort(sides.begin(), sides.end());
  const auto mm = [](double length) { return std::round(1e4 * length) / 10.0; };
  if (sides[0] < kHardlyApart) {
    return fmt::format("two markers are only {} mm apart: cameras confuse them", mm(sides[0]));
  }
  const double height = (p[1] - p[0]).cross(p[2] - p[0]).norm() / sides[2];
  if (height < kFlat * sides[2]) {
    return fmt::format(
        "three markers are in a line, up to {} mm: they do not tell how their link is turned",
        mm(height));
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (sides[i + 1] - sides[i] >= kAlike) continue;
    return fmt::format(
        "two distances are alike, {} and {} mm: exchanged labels are not found by them",
        mm(sides[i]), mm(sides[i + 1]));
  }
  return "";
}

void WarnOfCluster(const Project& project, const MarkerCluster& cluster,
                   std::vector<std::string>& warnings) {
  constexpr double kFar = 0.25;  // share of the robot's size, which is twice its longest branch
  const auto at = [&](int m) { return project.markers[Size(m)].p_link_marker; };
  const auto say = [&](const std::string& what) {
    warnings.push_back("cluster '" + cluster.name + "': " + what);
  };
  if (cluster.markers.size() == 3) {
    const std::string fault =
        TriangleFault({at(cluster.markers[0]), at(cluster.markers[1]), at(cluster.markers[2])});
    if (!fault.empty()) say(fault);
  }
  double furthest = 0.0;
  for (const int m : cluster.markers) furthest = std::max(furthest, at(m).norm());
  if (furthest > kFar * RobotSize(project.tree) && furthest > 1.0) {
    say(
        fmt::format("a marker is {:.0f} mm from the origin of its link, further than the robot's "
                    "parts are long; are the positions in mm and in the frame of the link?",
                    1e3 * furthest));
  }
}

/// Whether a joint joins the two bodies.
bool Carries(const RobotTree& tree, int body, int carried) {
  return carried > 0 && tree.joints[Size(carried - 1)].parent_body == body;
}

/// Warns of markers that are deep inside another part in the posture of rest. The spheres are
/// thicker than what they cover, and those of neighbours overlap.
void WarnOfHiddenMarkers(const Project& project, std::vector<std::string>& warnings) {
  constexpr double kDeep = 0.5;  // of the radius
  const RobotTree& tree = project.tree;
  const std::vector<Transform> poses = LinkTransforms(tree, project.motion.rest);
  for (const Marker& marker : project.markers) {
    const Eigen::Vector3d p = poses[Size(marker.link)] * marker.p_link_marker;
    for (const CollisionSphere& sphere : project.motion.spheres) {
      const int one = tree.links[Size(sphere.link)].body,
                other = tree.links[Size(marker.link)].body;
      if (one == other || Carries(tree, one, other) || Carries(tree, other, one)) continue;
      const double inside =
          sphere.radius - (poses[Size(sphere.link)] * sphere.p_link_centre - p).norm();
      if (inside < kDeep * sphere.radius) continue;
      warnings.push_back(fmt::format(
          "marker '{}': at rest it is {:.0f} mm inside the sphere '{}' of another link; cameras do "
          "not see it there, and what they do not see does not count: put it further out",
          marker.name, 1e3 * inside, sphere.name));
      break;
    }
  }
}

/// Warns of joints at the end of a chain beyond which there is no marker.
void WarnOfBlindEnd(const Project& project, const Chain& chain,
                    std::vector<std::string>& warnings) {
  const RobotTree& tree = project.tree;
  std::vector<int> joints = JointsToBody(tree, tree.links[Size(chain.tip_link)].body);
  std::string blind;
  bool seen = false;
  for (auto k = joints.rbegin(); k != joints.rend() && !seen; ++k) {
    if (*k + 1 == tree.links[Size(chain.from_link)].body) break;
    seen = std::any_of(project.markers.begin(), project.markers.end(), [&](const Marker& marker) {
      const std::vector<int> carriers = JointsToBody(tree, tree.links[Size(marker.link)].body);
      return std::find(carriers.begin(), carriers.end(), *k) != carriers.end();
    });
    if (!seen) blind = tree.joints[Size(*k)].name + (blind.empty() ? "" : ", " + blind);
  }
  if (blind.empty()) return;
  warnings.push_back("chain '" + chain.name + "': no marker moves with " + blind +
                     " at its end; what is beyond the last marker is not calibrated");
}

}  // namespace

std::vector<std::string> ProjectWarnings(const Project& project) {
  std::vector<std::string> warnings = project.tree.warnings;
  for (const Joint& joint : project.tree.joints) {
    if (joint.mimic || joint.limits.lower < joint.limits.upper) continue;
    warnings.push_back("joint '" + joint.name +
                       "': its lower and upper limits are equal; it is not moved, so that its "
                       "offset is not told from the frames beside it: give it its range");
  }
  for (const MarkerCluster& cluster : project.clusters) WarnOfCluster(project, cluster, warnings);
  WarnOfHiddenMarkers(project, warnings);
  for (const Chain& chain : project.chains) WarnOfBlindEnd(project, chain, warnings);
  for (std::string& warning : InertiaWarnings(project.tree)) {
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace elastocal
