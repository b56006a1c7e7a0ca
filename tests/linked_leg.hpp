// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/test_robots.hpp"

namespace elastocal {

/// An invented leg: hip_roll and hip_pitch; a knee that an actuator in the thigh bends; and an
/// ankle of pitch and roll that two motors in the shank move by cranks and rods (linkages 0 and 1).
/// Links pelvis, hip, thigh, shank, cross, foot. z is up, x ahead.
inline RobotTree LinkedLeg(bool linked = true) {
  RobotTree tree = MakeRoot();
  tree.links[0].name = "pelvis";
  const auto add = [&](const char* joint, const char* link, int parent, const Transform& origin,
                       const Eigen::Vector3d& axis, double lower, double upper) {
    const int index = AddJoint(tree, joint, parent, origin, axis);
    tree.links[index].name = link;
    tree.joints.back().limits.lower = lower;
    tree.joints.back().limits.upper = upper;
    return index;
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const int hip = add("hip_roll", "hip", 0, Offset(0.0, 0.1, -0.05), x, -0.5, 0.5);
  const int thigh = add("hip_pitch", "thigh", hip, Offset(0.02, 0.03, 0.0), y, -1.2, 0.8);
  const int shank = add("knee", "shank", thigh, Offset(0.0, 0.0, -0.4), y, 0.0, 1.5);
  const int cross = add("ankle_pitch", "cross", shank, Offset(0.0, 0.0, -0.38), y, -0.7, 0.6);
  const int foot = add("ankle_roll", "foot", cross, Offset(0.0, 0.0, -0.01), x, -0.35, 0.35);
  if (!linked) return tree;
  const std::vector<RodUncertainty> usual = {{RodQuantity::kLength, 1e-3},
                                             {RodQuantity::kZero, 0.01}};

  Rod knee;
  knee.motor = "knee_actuator";
  knee.actuator = true;
  knee.from_link = thigh;
  knee.to_link = shank;
  knee.centre = {-0.06, 0.0, -0.08};
  knee.anchor = {-0.05, 0.0, -0.02};
  knee.uncertain = {{RodQuantity::kLength, 1e-3}};
  AddLinkage({"knee", {FindJoint(tree, "knee")}, {knee}, Eigen::VectorXd::Constant(1, 0.7)}, tree);

  Linkage ankle{"ankle",
                {FindJoint(tree, "ankle_pitch"), FindJoint(tree, "ankle_roll")},
                {},
                Eigen::VectorXd::Zero(2)};
  for (const double side : {1.0, -1.0}) {
    Rod rod;
    rod.motor = side > 0.0 ? "ankle_outer" : "ankle_inner";
    rod.from_link = shank;
    rod.to_link = foot;
    rod.axis = y;
    rod.centre = {0.0, side * 0.05, side > 0.0 ? -0.10 : -0.18};
    rod.pin = rod.centre + Eigen::Vector3d(-0.04, 0.0, 0.0);
    rod.anchor = {-0.045, side * 0.045, 0.01};
    rod.uncertain = usual;
    ankle.rods.push_back(rod);
  }
  AddLinkage(ankle, tree);
  return tree;
}

/// Three markers on the pelvis, the shank and the foot.
inline std::vector<Marker> LinkedLegMarkers(const RobotTree& tree) {
  std::vector<Marker> markers;
  const Eigen::Vector3d at[] = {{0.08, 0.02, 0.03}, {-0.03, 0.07, -0.02}, {0.02, -0.06, 0.05}};
  for (const char* link : {"pelvis", "shank", "foot"}) {
    for (int i = 0; i < 3; ++i) {
      markers.push_back({link + std::to_string(i), FindLink(tree, link), at[i]});
    }
  }
  return markers;
}

}  // namespace elastocal
