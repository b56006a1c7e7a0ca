// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/legs.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {

/// A humanoid of 60 kg: two legs of six joints (with TALOS's lengths), a trunk of two joints, and
/// three markers on each of waist, trunk and feet.
struct Biped {
  RobotTree tree;
  std::vector<NamedChain> chains;
  std::vector<Marker> markers;
};

inline void GiveMass(Link& link, double mass, const Eigen::Vector3d& com) {
  link.mass = mass;
  link.com = com;
  link.inertia = 0.02 * mass * Eigen::Matrix3d::Identity();
}

inline void AddMarkers(Biped& biped, const std::string& name, int link) {
  biped.markers.push_back({name + "_1", link, {0.08, 0.03, 0.02}});
  biped.markers.push_back({name + "_2", link, {-0.05, 0.06, 0.01}});
  biped.markers.push_back({name + "_3", link, {0.02, -0.07, 0.05}});
}

/// Adds a leg on the side of y = `side` (+1 or -1) and returns its sole.
inline int AddLeg(RobotTree& tree, const std::string& name, double side) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  int link = AddJoint(tree, name + "_1", 0, Offset(-0.02, side * 0.085, -0.27), z);
  link = AddJoint(tree, name + "_2", link, Transform::Identity(), x);
  link = AddJoint(tree, name + "_3", link, Transform::Identity(), y);
  GiveMass(tree.links[static_cast<std::size_t>(link)], 5.0, {0.0, 0.0, -0.18});
  link = AddJoint(tree, name + "_4", link, Offset(0, 0, -0.38), y);
  GiveMass(tree.links[static_cast<std::size_t>(link)], 3.0, {0.0, 0.0, -0.15});
  link = AddJoint(tree, name + "_5", link, Offset(0, 0, -0.325), y);
  link = AddJoint(tree, name + "_6", link, Transform::Identity(), x);
  GiveMass(tree.links[static_cast<std::size_t>(link)], 1.5, {0.0, 0.0, -0.05});
  const double lower[] = {-0.5, -0.52, -2.1, 0.0, -1.27, -0.52};
  const double upper[] = {0.5, 0.52, 0.7, 2.6, 0.68, 0.52};
  for (std::size_t k = 0; k < 6; ++k) {
    JointLimits& limits = tree.joints[tree.joints.size() - 6 + k].limits;
    limits = {lower[k], upper[k], 5.0, 150.0};
  }
  return AddFixedLink(tree, name + "_sole", link, Offset(0, 0, -0.107));
}

inline Biped MakeBiped() {
  Biped biped;
  biped.tree = MakeRoot();
  RobotTree& tree = biped.tree;
  GiveMass(tree.links[0], 12.0, {-0.03, 0.0, -0.08});
  int trunk = AddJoint(tree, "trunk_yaw", 0, Offset(0, 0, 0.07), {0, 0, 1});
  trunk = AddJoint(tree, "trunk_pitch", trunk, Transform::Identity(), {0, 1, 0});
  GiveMass(tree.links[static_cast<std::size_t>(trunk)], 29.0, {0.0, 0.01, 0.25});
  for (std::size_t k = 0; k < 2; ++k) tree.joints[k].limits = {-0.6, 0.6, 5.0, 150.0};
  const int left = AddLeg(tree, "left", 1.0);
  const int right = AddLeg(tree, "right", -1.0);
  biped.chains = {{"trunk", 0, trunk}, {"left", 0, left}, {"right", 0, right}};
  AddMarkers(biped, "WAIST", 0);
  AddMarkers(biped, "TRUNK", trunk);
  AddMarkers(biped, "LFOOT", left);
  AddMarkers(biped, "RFOOT", right);
  return biped;
}

}  // namespace elastocal
