// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/robot_tree.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

template <typename Item>
int FindByName(const std::vector<Item>& items, const std::string& name, const char* what,
               const std::string& robot) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
    names.push_back(items[i].name);
  }
  throw InputError("robot '" + robot + "' has no " + what + " '" + name + "'" +
                   DidYouMean(name, names));
}

Transform JointMotion(const Joint& joint, double position) {
  return joint.type == JointType::kRevolute
             ? RotAxis(joint.axis, position)
             : Transform(Eigen::Translation3d(position * joint.axis));
}

}  // namespace

int FindLink(const RobotTree& tree, const std::string& name) {
  return FindByName(tree.links, name, "link", tree.name);
}

int FindJoint(const RobotTree& tree, const std::string& name) {
  return FindByName(tree.joints, name, "movable joint", tree.name);
}

std::vector<Drive> DrivesOf(const Joint& joint) {
  std::vector<Drive> drives = {{joint.coordinate, joint.multiplier}};
  drives.insert(drives.end(), joint.more.begin(), joint.more.end());
  return drives;
}

bool IsMovedBy(const Joint& joint, int coordinate) {
  return joint.coordinate == coordinate ||
         std::any_of(joint.more.begin(), joint.more.end(),
                     [&](const Drive& drive) { return drive.coordinate == coordinate; });
}

bool IsMovedBy(const Joint& joint, const std::vector<int>& coordinates) {
  return std::any_of(coordinates.begin(), coordinates.end(),
                     [&](int coordinate) { return IsMovedBy(joint, coordinate); });
}

double JointRate(const Joint& joint, const Eigen::VectorXd& q_rate) {
  double rate = joint.multiplier * q_rate[joint.coordinate];
  for (const Drive& drive : joint.more) rate += drive.multiplier * q_rate[drive.coordinate];
  return rate;
}

void AddTorque(const Joint& joint, double torque, Eigen::VectorXd& torques) {
  torques[joint.coordinate] += joint.multiplier * torque;
  for (const Drive& drive : joint.more) torques[drive.coordinate] += drive.multiplier * torque;
}

double JointPosition(const Joint& joint, const Eigen::VectorXd& q) {
  return JointRate(joint, q) + joint.offset;
}

Transform ParentBodyToChild(const RobotTree& tree, int joint, const Eigen::VectorXd& q) {
  const Joint& moving = tree.joints[joint];
  return tree.links[moving.parent_link].T_body_link * moving.T_parent_child *
         JointMotion(moving, JointPosition(moving, q));
}

std::vector<Transform> LinkTransforms(const RobotTree& tree,
                                      const std::vector<Transform>& T_ref_body) {
  std::vector<Transform> T_ref_link;
  T_ref_link.reserve(tree.links.size());
  for (const Link& link : tree.links) {
    T_ref_link.push_back(T_ref_body[link.body] * link.T_body_link);
  }
  return T_ref_link;
}

std::vector<Transform> LinkTransforms(const RobotTree& tree, const Eigen::VectorXd& q) {
  std::vector<Transform> T_root_body(tree.body_count(), Transform::Identity());
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
    T_root_body[k + 1] = T_root_body[tree.joints[k].parent_body] * ParentBodyToChild(tree, k, q);
  }
  return LinkTransforms(tree, T_root_body);
}

std::vector<int> JointsToBody(const RobotTree& tree, int body) {
  std::vector<int> joints;
  for (; body > 0; body = tree.joints[body - 1].parent_body) joints.push_back(body - 1);
  std::reverse(joints.begin(), joints.end());
  return joints;
}

double RobotSize(const RobotTree& tree) {
  std::vector<double> reach(tree.body_count(), 0.0);
  double longest = 0.0;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    double stroke = 0.0;
    if (joint.type == JointType::kPrismatic && std::isfinite(joint.limits.upper)) {
      stroke = std::max(std::abs(joint.limits.lower), std::abs(joint.limits.upper));
    }
    const Transform T_body_child = tree.links[joint.parent_link].T_body_link * joint.T_parent_child;
    reach[k + 1] = reach[joint.parent_body] + T_body_child.translation().norm() + stroke;
  }
  for (const Link& link : tree.links) {
    longest = std::max(longest, reach[link.body] + link.T_body_link.translation().norm());
  }
  return 2.0 * longest;
}

std::pair<double, double> PostureRange(const Joint& joint, double margin, double around) {
  const bool turns = joint.type == JointType::kRevolute;
  const double unlimited = turns ? M_PI : 0.5;
  double lower = std::isfinite(joint.limits.lower) ? joint.limits.lower : -unlimited;
  double upper = std::isfinite(joint.limits.upper) ? joint.limits.upper : unlimited;
  if (turns && upper - lower > 2.0 * M_PI) {
    const double middle = std::max(lower + M_PI, std::min(around, upper - M_PI));
    lower = middle - M_PI;
    upper = middle + M_PI;
  }
  const double kept = margin * (upper - lower);
  return {lower + kept, upper - kept};
}

namespace {

Eigen::VectorXd DrawPosture(const RobotTree& tree, Random& random) {
  Eigen::VectorXd q(tree.coordinate_count());
  for (int i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = PostureRange(tree.joints[tree.coordinate_joint[i]]);
    q[i] = random.Uniform(lower, upper);
  }
  return q;
}

}  // namespace

Eigen::VectorXd RandomPosture(const RobotTree& tree, Random& random) {
  constexpr int kMostTries = 1000;
  Eigen::VectorXd q = DrawPosture(tree, random);
  for (int i = 0; i < kMostTries && !LinkagesClose(tree, q); ++i) q = DrawPosture(tree, random);
  return q;
}

}  // namespace elastocal
