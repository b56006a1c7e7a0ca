// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/other_followers.hpp"

#include <map>

#include <fmt/format.h>

#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

/// A joint, and the place of the joint that it follows.
struct Follower {
  std::size_t joint = 0, drive = 0;
};

std::vector<std::vector<Follower>> GroupsOf(const RobotTree& tree) {
  std::vector<std::vector<Follower>> groups;
  std::map<int, std::vector<Follower>> led;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (!tree.joints[k].mimic) continue;
    const std::vector<Drive> drives = DrivesOf(tree.joints[k]);
    for (std::size_t d = 0; d < drives.size(); ++d) {
      groups.push_back({{k, d}});
      led[drives[d].coordinate].push_back({k, d});
    }
  }
  for (const auto& [coordinate, followers] : led) {
    if (followers.size() > 1) groups.push_back(followers);
  }
  return groups;
}

FollowerAlternative Following(const Project& project, const std::vector<Follower>& group,
                              double factor) {
  FollowerAlternative other{"", project};
  const RobotTree& tree = project.tree;
  for (const Follower& one : group) {
    const Drive drive = DrivesOf(tree.joints[one.joint])[one.drive];
    Joint& joint = other.project.tree.joints[one.joint];
    (one.drive == 0 ? joint.multiplier : joint.more[one.drive - 1].multiplier) *= factor;
    const Joint& leads = JointOfCoordinate(tree, drive.coordinate);
    other.what +=
        (other.what.empty() ? "" : ", ") +
        fmt::format("{} seems to follow {} by a factor of {:g}, not {:g} as described", joint.name,
                    leads.name, factor * drive.multiplier + 0.0, drive.multiplier);
  }
  other.what += " (couplings of the project, mimic of the URDF)";
  return other;
}

}  // namespace

std::vector<FollowerAlternative> OtherFollowers(const Project& project) {
  std::vector<FollowerAlternative> others;
  for (const std::vector<Follower>& group : GroupsOf(project.tree)) {
    for (const double factor : {-1.0, 0.0}) others.push_back(Following(project, group, factor));
  }
  return others;
}

}  // namespace elastocal
