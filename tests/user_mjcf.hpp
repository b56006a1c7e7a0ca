// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

inline std::string PoseText(const Transform& T) {
  const Eigen::Quaterniond q(T.linear());
  const Eigen::Vector3d p = T.translation();
  return fmt::format(R"(pos="{:.17g} {:.17g} {:.17g}" quat="{:.17g} {:.17g} {:.17g} {:.17g}")",
                     p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

/// The links of a body of the tree as one point mass (with some inertia), which suffices for
/// statics.
inline std::string InertialText(const RobotTree& tree, int body) {
  const BodyInertia inertia = BodyInertias(tree)[static_cast<std::size_t>(body)];
  const double mass = inertia.mass;
  const Eigen::Vector3d& com = inertia.com;
  return fmt::format(
      "<inertial pos=\"{:.17g} {:.17g} {:.17g}\" mass=\"{:.17g}\" diaginertia=\"{} {} {}\"/>\n",
      com.x(), com.y(), com.z(), std::max(mass, 1e-6), 0.01 + 0.01 * mass, 0.01 + 0.01 * mass,
      0.01 + 0.01 * mass);
}

/// A user's model with position-controlled motors and other elements that the export must not
/// change.
struct UserModel {
  const RobotTree& tree;

  std::string BodiesOn(int parent_body) const {
    std::string text;
    for (std::size_t k = 0; k < tree.joints.size(); ++k) {
      const Joint& joint = tree.joints[k];
      if (joint.parent_body != parent_body) continue;
      const Transform T = tree.links[static_cast<std::size_t>(joint.parent_link)].T_body_link *
                          joint.T_parent_child;
      text += fmt::format(
          "<body name=\"{}\" {}><!-- </body> in a comment -->\n{}"
          "<joint name=\"{}\" type=\"{}\" axis=\"{:.17g} {:.17g} {:.17g}\" armature=\"1\" "
          "damping=\"300\" limited=\"false\"/>\n",
          tree.links[static_cast<std::size_t>(joint.child_link)].name, PoseText(T),
          InertialText(tree, static_cast<int>(k) + 1), joint.name,
          joint.type == JointType::kRevolute ? "hinge" : "slide", joint.axis.x(), joint.axis.y(),
          joint.axis.z());
      text += BodiesOn(static_cast<int>(k) + 1) + "</body>\n";
    }
    return text;
  }

  std::string Text(bool floats) const {
    const auto root = std::find_if(tree.links.begin(), tree.links.end(), [](const Link& link) {
      return link.body == 0 && link.T_body_link.isApprox(Transform::Identity());
    });
    std::string motors;
    for (const Joint& joint : tree.joints) {
      motors += fmt::format("<position name=\"{0}\" joint=\"{0}\" kp=\"20000\"/>\n", joint.name);
    }
    return "<mujoco><compiler angle=\"radian\"/>\n"
           "<option timestep=\"0.001\"/><default><joint damping=\"7\" limited=\"true\" "
           "range=\"-1e-3 1e-3\" frictionloss=\"100\"/></default>\n<worldbody>\n<body name=\"" +
           root->name + "\">" + (floats ? "<freejoint name=\"float\"/>" : "") +
           InertialText(tree, 0) + BodiesOn(0) + "</body>\n</worldbody>\n<actuator>\n" + motors +
           "</actuator></mujoco>\n";
  }
};

}  // namespace elastocal
