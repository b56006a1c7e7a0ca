// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/subtree.hpp"

#include <algorithm>
#include <map>

namespace elastocal {

RobotTree Subtree(const RobotTree& tree, int link) {
  RobotTree subtree;
  subtree.name = tree.name;
  std::map<int, int> body_of, link_of, coordinate_of;  // index in the tree -> in the subtree
  body_of[tree.links[link].body] = 0;
  std::vector<int> joints;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (!body_of.contains(tree.joints[k].parent_body)) continue;
    joints.push_back(static_cast<int>(k));
    body_of[static_cast<int>(k) + 1] = static_cast<int>(joints.size());
  }
  // The link whose frame is the root body's frame comes first, as in every tree.
  const int root_body = tree.links[link].body;
  const int root_link = root_body == 0 ? 0 : tree.joints[root_body - 1].child_link;
  const auto add_link = [&](int i) {
    link_of[i] = static_cast<int>(subtree.links.size());
    subtree.links.push_back(tree.links[i]);
    subtree.links.back().body = body_of.at(tree.links[i].body);
  };
  add_link(root_link);
  for (int i = 0; i < static_cast<int>(tree.links.size()); ++i) {
    if (i != root_link && body_of.contains(tree.links[i].body)) add_link(i);
  }
  for (int k : joints) {
    Joint joint = tree.joints[k];
    joint.parent_link = link_of.at(joint.parent_link);
    joint.child_link = link_of.at(joint.child_link);
    joint.parent_body = body_of.at(joint.parent_body);
    const int index = static_cast<int>(subtree.joints.size());
    const auto renumber = [&](int coordinate) {
      const auto [entry, is_new] =
          coordinate_of.try_emplace(coordinate, subtree.coordinate_count());
      if (is_new) subtree.coordinate_joint.push_back(index);
      return entry->second;
    };
    joint.coordinate = renumber(joint.coordinate);
    for (Drive& drive : joint.more) drive.coordinate = renumber(drive.coordinate);
    if (!joint.mimic) subtree.coordinate_joint[joint.coordinate] = index;
    subtree.joints.push_back(joint);
  }
  const auto index_of = [&](int k) {
    return static_cast<int>(std::find(joints.begin(), joints.end(), k) - joints.begin());
  };
  for (Linkage linkage : tree.linkages) {
    const auto is_inside = [&](const Rod& rod) { return link_of.contains(rod.from_link); };
    if (!std::all_of(linkage.rods.begin(), linkage.rods.end(), is_inside)) continue;
    for (int& k : linkage.joints) k = index_of(k);
    for (Rod& rod : linkage.rods) {
      rod.from_link = link_of.at(rod.from_link);
      rod.to_link = link_of.at(rod.to_link);
    }
    subtree.linkages.push_back(std::move(linkage));
  }
  return subtree;
}

std::vector<Marker> SubtreeMarkers(const RobotTree& tree, const RobotTree& subtree,
                                   const std::vector<Marker>& markers) {
  std::vector<Marker> inside;
  for (Marker marker : markers) {
    const std::string& name = tree.links[marker.link].name;
    for (std::size_t i = 0; i < subtree.links.size(); ++i) {
      if (subtree.links[i].name != name) continue;
      marker.link = static_cast<int>(i);
      inside.push_back(marker);
    }
  }
  return inside;
}

}  // namespace elastocal
