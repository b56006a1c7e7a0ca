// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "elastocal/math/random.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {

/// Relation of a joint's axis to the axis of the joint before it.
enum class AxisRelation {
  kAny,
  kIntersecting,
  kParallel,
  kAntiparallel,
  kNearlyParallel,
  kCoaxial
};

/// A rotation and a translation of up to 0.3 m along each axis.
inline Transform RandomTransform(Random& random) {
  Transform T = RotAxis(random.NormalVector(3, 1.0).normalized(), random.Uniform(-M_PI, M_PI));
  for (double& x : T.translation()) x = random.Uniform(-0.3, 0.3);
  return T;
}

/// Adds a joint in this relation to the joint that moves its parent link. Returns its link.
inline int AddRelatedJoint(RobotTree& tree, const std::string& name, int parent_link,
                           AxisRelation relation, JointType type, Random& random) {
  const Joint& before = tree.joints.at(tree.links[parent_link].body - 1);
  const Transform T_link_body = tree.links[parent_link].T_body_link.inverse();
  const Eigen::Vector3d along = T_link_body.linear() * before.axis;
  const Eigen::Vector3d on_axis = T_link_body.translation() + random.Uniform(-0.3, 0.3) * along;

  Transform T = RandomTransform(random);
  Eigen::Vector3d axis = random.NormalVector(3, 1.0).normalized();
  switch (relation) {
    case AxisRelation::kAny:
      break;
    case AxisRelation::kIntersecting:
      T.translation() = on_axis + 0.2 * axis;
      break;
    case AxisRelation::kParallel:
      axis = along;
      break;
    case AxisRelation::kAntiparallel:
      axis = -along;
      break;
    case AxisRelation::kNearlyParallel:
      axis = RotAxis(along.unitOrthogonal(), 0.01) * along;
      break;
    case AxisRelation::kCoaxial:
      axis = along;
      T.translation() = on_axis;
      break;
  }
  return AddJoint(tree, name, parent_link, T, T.linear().transpose() * axis, type);
}

/// A robot of three to nine joints `j0`, `j1`..., of which one in five slides. It has some branches
/// and fixed links, and neighbouring axes have the given relations.
inline RobotTree RandomRobot(const std::vector<AxisRelation>& relations, Random& random) {
  RobotTree tree = MakeRoot();
  const int joint_count = 3 + random.Index(7);
  int link = 0;
  for (int k = 0; k < joint_count; ++k) {
    if (random.Index(5) == 0) link = random.Index(static_cast<int>(tree.links.size()));
    if (random.Index(4) == 0) {
      link = AddFixedLink(tree, "fixed" + std::to_string(k), link, RandomTransform(random));
    }
    const JointType type = random.Index(5) == 0 ? JointType::kPrismatic : JointType::kRevolute;
    const std::string name = "j" + std::to_string(k);
    if (tree.links[link].body == 0) {
      const Transform T = RandomTransform(random);
      link = AddJoint(tree, name, link, T, random.NormalVector(3, 1.0), type);
    } else {
      const int relation = random.Index(static_cast<int>(relations.size()));
      link = AddRelatedJoint(tree, name, link, relations[relation], type, random);
    }
  }
  return tree;
}

/// The relations of axes in real robots.
inline const std::vector<AxisRelation> kUsualRelations = {
    AxisRelation::kAny, AxisRelation::kIntersecting, AxisRelation::kParallel,
    AxisRelation::kAntiparallel, AxisRelation::kNearlyParallel};

/// Three markers on the last link of each branch and one on the root, at random positions.
inline std::vector<Marker> RandomMarkers(const RobotTree& tree, Random& random) {
  std::vector<bool> carries_joint(tree.body_count(), false);
  for (const Joint& joint : tree.joints) carries_joint[joint.parent_body] = true;
  std::vector<Marker> markers = {{"ROOT", 0, random.NormalVector(3, 0.1)}};
  for (int link = 0; link < static_cast<int>(tree.links.size()); ++link) {
    if (carries_joint[tree.links[link].body]) continue;
    for (const char* number : {"_1", "_2", "_3"}) {
      markers.push_back({tree.links[link].name + number, link, random.NormalVector(3, 0.1)});
    }
  }
  return markers;
}

}  // namespace elastocal
