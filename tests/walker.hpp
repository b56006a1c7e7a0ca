// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/motion/standing_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {

inline void GiveMass(RobotTree& tree, int link, double mass, const Eigen::Vector3d& com) {
  tree.links[static_cast<std::size_t>(link)].mass = mass;
  tree.links[static_cast<std::size_t>(link)].com = com;
  tree.links[static_cast<std::size_t>(link)].inertia = 0.02 * mass * Eigen::Matrix3d::Identity();
}

/// Adds a leg with the lengths of TALOS. Returns the sole.
inline int AddWalkingLeg(RobotTree& tree, const std::string& name, double side) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  int link = AddJoint(tree, name + "_1", 0, Offset(-0.02, side * 0.085, -0.27), {0, 0, 1});
  link = AddJoint(tree, name + "_2", link, Transform::Identity(), x);
  link = AddJoint(tree, name + "_3", link, Transform::Identity(), y);
  GiveMass(tree, link, 5.0, {0.0, 0.0, -0.18});
  link = AddJoint(tree, name + "_4", link, Offset(0, 0, -0.38), y);
  GiveMass(tree, link, 3.0, {0.0, 0.0, -0.15});
  link = AddJoint(tree, name + "_5", link, Offset(0, 0, -0.325), y);
  link = AddJoint(tree, name + "_6", link, Transform::Identity(), x);
  GiveMass(tree, link, 1.5, {0.0, 0.0, -0.05});
  const double lower[] = {-0.5, -0.52, -2.1, 0.0, -1.27, -0.52};
  const double upper[] = {0.5, 0.52, 0.7, 2.6, 0.68, 0.52};
  for (std::size_t k = 0; k < 6; ++k) {
    tree.joints[tree.joints.size() - 6 + k].limits = {lower[k], upper[k], 5.0, 150.0};
  }
  return AddFixedLink(tree, name + "_sole", link, Offset(0, 0, -0.107));
}

struct Walker {
  RobotTree tree;
  std::vector<Sole> soles;
  int hand = 0, belly = 0;
};

/// A robot of 60 kg: waist, a trunk that turns and bends, an arm of one joint in front, and two
/// legs.
inline Walker MakeWalker() {
  Walker walker;
  walker.tree = MakeRoot();
  RobotTree& tree = walker.tree;
  GiveMass(tree, 0, 12.0, {-0.03, 0.0, -0.08});
  int link = AddJoint(tree, "trunk_yaw", 0, Offset(0, 0, 0.07), {0, 0, 1});
  link = AddJoint(tree, "trunk_pitch", link, Transform::Identity(), {0, 1, 0});
  GiveMass(tree, link, 25.0, {0.0, 0.01, 0.25});
  walker.belly = link;
  walker.hand = AddJoint(tree, "arm", link, Offset(0.1, -0.2, 0.3), {0, 0, 1});
  GiveMass(tree, walker.hand, 4.0, {0.3, 0.0, 0.0});
  for (std::size_t k = 0; k < 3; ++k) tree.joints[k].limits = {-1.2, 1.2, 5.0, 150.0};
  for (const double side : {1.0, -1.0}) {
    const int sole = AddWalkingLeg(tree, side > 0 ? "left" : "right", side);
    walker.soles.push_back({sole, {-0.1, -0.06}, {0.1, 0.06}});
  }
  return walker;
}

}  // namespace elastocal
