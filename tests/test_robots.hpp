// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

// Robots made by hand, for the tests of layers that cannot read a URDF.

inline RobotTree MakeRoot() {
  RobotTree tree;
  tree.name = "robot";
  tree.links.push_back({.name = "root", .T_body_link = Transform::Identity()});
  return tree;
}

inline Transform Offset(double x, double y, double z) {
  return Transform(Eigen::Translation3d(x, y, z));
}

/// Adds the joint `<name>` and, after it, the link `<name>_link`; limits are -1 and 1. Returns the
/// link.
inline int AddJoint(RobotTree& tree, const std::string& name, int parent_link,
                    const Transform& T_parent_child, const Eigen::Vector3d& axis,
                    JointType type = JointType::kRevolute) {
  const int link = static_cast<int>(tree.links.size());
  const int joint = static_cast<int>(tree.joints.size());
  const double infinity = std::numeric_limits<double>::infinity();
  tree.joints.push_back({.name = name,
                         .type = type,
                         .parent_link = parent_link,
                         .child_link = link,
                         .parent_body = tree.links[parent_link].body,
                         .T_parent_child = T_parent_child,
                         .axis = axis.normalized(),
                         .limits = {-1.0, 1.0, infinity, infinity},
                         .coordinate = tree.coordinate_count()});
  tree.coordinate_joint.push_back(joint);
  tree.links.push_back(
      {.name = name + "_link", .body = joint + 1, .T_body_link = Transform::Identity()});
  return link;
}

/// Adds a link on a fixed joint. Returns it.
inline int AddFixedLink(RobotTree& tree, const std::string& name, int parent_link,
                        const Transform& T_parent_child) {
  const Link parent = tree.links[parent_link];
  tree.links.push_back(
      {.name = name, .body = parent.body, .T_body_link = parent.T_body_link * T_parent_child});
  return static_cast<int>(tree.links.size()) - 1;
}

/// Makes the joint that was added last follow another: position = multiplier * q + offset.
inline void MakeLastJointMimic(RobotTree& tree, int leader, double multiplier, double offset) {
  Joint& joint = tree.joints.back();
  tree.coordinate_joint.pop_back();
  joint.coordinate = tree.joints[leader].coordinate;
  joint.multiplier = multiplier;
  joint.offset = offset;
  joint.mimic = true;
}

/// Two revolute joints about z, links along x of 0.5 m and 0.3 m; the links are 1, 2 and the tip 3.
inline RobotTree PlanarArm() {
  RobotTree tree = MakeRoot();
  const int upper = AddJoint(tree, "shoulder", 0, Transform::Identity(), {0, 0, 1});
  const int lower = AddJoint(tree, "elbow", upper, Offset(0.5, 0, 0), {0, 0, 1});
  AddFixedLink(tree, "tip", lower, Offset(0.3, 0, 0));
  return tree;
}

/// The left leg of TALOS, joints `leg_1` to `leg_6`.
inline RobotTree TalosLeg() {
  using Eigen::Vector3d;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  RobotTree tree = MakeRoot();
  AddJoint(tree, "leg_1", 0, Offset(-0.02, 0.085, -0.27105), z);
  AddJoint(tree, "leg_2", 1, Transform::Identity(), x);
  AddJoint(tree, "leg_3", 2, Transform::Identity(), y);
  AddJoint(tree, "leg_4", 3, Offset(0, 0, -0.38), y);
  AddJoint(tree, "leg_5", 4, Offset(0, 0, -0.325), y);
  AddJoint(tree, "leg_6", 5, Transform::Identity(), x);
  const double lower[] = {-0.35, -0.52, -2.1, 0.0, -1.27, -0.52};
  const double upper[] = {1.57, 0.52, 0.7, 2.6, 0.68, 0.52};
  for (int k = 0; k < 6; ++k) {
    tree.joints[k].limits.lower = lower[k];
    tree.joints[k].limits.upper = upper[k];
  }
  return tree;
}

/// The leg with the paper's nine markers: three each on thigh, shank and foot.
inline ErrorModel TalosLegModel() {
  return MakeErrorModel(TalosLeg(), {{"THIGH_1", 3, {0.07, 0.04, -0.09}},
                                     {"THIGH_2", 3, {0.07, 0.085, -0.23}},
                                     {"THIGH_3", 3, {-0.01, 0.11, -0.16}},
                                     {"SHANK_1", 4, {0.065, 0.035, -0.08}},
                                     {"SHANK_2", 4, {0.065, -0.01, -0.22}},
                                     {"SHANK_3", 4, {0.0, 0.06, -0.15}},
                                     {"FOOT_1", 6, {0.085, 0.045, -0.072}},
                                     {"FOOT_2", 6, {0.07, -0.05, -0.072}},
                                     {"FOOT_3", 6, {0.03, 0.012, -0.045}}});
}

/// A carriage on an oblique rail with an arm of three oblique axes, whose last body carries two
/// fingers; the second finger slides opposite to the first.
inline RobotTree RailArm() {
  RobotTree tree = MakeRoot();
  const int mount = AddFixedLink(tree, "mount", 0, FromXyzRpy({0.1, 0, 0.2}, {0.1, 0.2, 0.3}));
  const int carriage =
      AddJoint(tree, "rail", mount, Offset(0, 0.1, 0), {1, 1, 0.2}, JointType::kPrismatic);
  const int turret =
      AddJoint(tree, "turret", carriage, FromXyzRpy({0, 0, 0.3}, {0.5, 0, 0}), {0.1, 0, 1});
  const int arm = AddJoint(tree, "arm", turret, FromXyzRpy({0.2, 0, 0.1}, {0, 0.3, 1}), {0, 1, 0});
  const int flange = AddFixedLink(tree, "flange", arm, FromXyzRpy({0.3, 0, 0}, {1, 0, 0}));
  const int hand = AddJoint(tree, "hand", flange, Offset(0, 0, 0.1), {1, 2, 3});
  AddJoint(tree, "finger_1", hand, Offset(0.05, 0.02, 0), {0, 1, 0}, JointType::kPrismatic);
  AddJoint(tree, "finger_2", hand, Offset(0.05, -0.02, 0), {0, 1, 0}, JointType::kPrismatic);
  MakeLastJointMimic(tree, 4, -1.0, 0.01);
  return tree;
}

}  // namespace elastocal
