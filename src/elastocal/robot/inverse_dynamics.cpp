// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/inverse_dynamics.hpp"

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// How a body moves, in the world's axes.
struct BodyMotion {
  Transform T_world_body = Transform::Identity();
  Vector3d turn, turn_rate, acceleration;  // the acceleration is that of its origin
};

/// Motion of the body that a joint moves, from that of the body it is mounted on.
BodyMotion Outwards(const RobotTree& tree, int k, const BodyMotion& parent, const RobotState& state,
                    Vector3d& axis) {
  const Joint& joint = tree.joints[k];
  const double rate = JointRate(joint, state.velocity);
  const double acceleration = JointRate(joint, state.acceleration);
  BodyMotion child;
  child.T_world_body = parent.T_world_body * ParentBodyToChild(tree, k, state.q);
  axis = child.T_world_body.linear() * joint.axis;
  const Vector3d lever = child.T_world_body.translation() - parent.T_world_body.translation();
  child.turn = parent.turn;
  child.turn_rate = parent.turn_rate;
  child.acceleration = parent.acceleration + parent.turn_rate.cross(lever) +
                       parent.turn.cross(parent.turn.cross(lever));
  if (joint.type == JointType::kRevolute) {
    child.turn += rate * axis;
    child.turn_rate += acceleration * axis + parent.turn.cross(rate * axis);
  } else {
    child.acceleration += acceleration * axis + 2.0 * rate * parent.turn.cross(axis);
  }
  return child;
}

}  // namespace

std::vector<BodyInertia> BodyInertias(const RobotTree& tree) {
  std::vector<BodyInertia> inertias(tree.body_count());
  for (const Link& link : tree.links) {
    inertias[link.body].mass += link.mass;
    inertias[link.body].com += link.mass * (link.T_body_link * link.com);
  }
  for (BodyInertia& body : inertias) {
    if (body.mass > 0.0) body.com /= body.mass;
  }
  for (const Link& link : tree.links) {
    BodyInertia& body = inertias[link.body];
    const Eigen::Matrix3d R = link.T_body_link.linear();
    const Eigen::Matrix3d lever = Skew(link.T_body_link * link.com - body.com);
    body.inertia += R * link.inertia * R.transpose() - link.mass * lever * lever;
  }
  return inertias;
}

InverseDynamicsResult InverseDynamics(const RobotTree& tree,
                                      const std::vector<BodyInertia>& inertias,
                                      const RobotState& state, const Vector3d& gravity,
                                      const std::vector<LinkWrench>& wrenches) {
  InterruptionPoint();
  // First pass, outwards: how the bodies move. Second pass, inwards: sum of the wrenches that move
  // them, about the world's origin.
  std::vector<BodyMotion> motion(tree.body_count());
  std::vector<Vector3d> axes(tree.joints.size());
  motion[0] = {state.T_world_root, state.root_turn, state.root_turn_rate, state.root_acceleration};
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
    motion[k + 1] = Outwards(tree, k, motion[tree.joints[k].parent_body], state, axes[k]);
  }
  InverseDynamicsResult result;
  result.com.setZero();
  double mass = 0.0;
  std::vector<Vector3d> forces(motion.size()), moments(motion.size());
  for (std::size_t b = 0; b < motion.size(); ++b) {
    const BodyMotion& body = motion[b];
    const Eigen::Matrix3d R = body.T_world_body.linear();
    const Vector3d lever = R * inertias[b].com;
    const Vector3d com = body.T_world_body.translation() + lever;
    const Vector3d acceleration =
        body.acceleration + body.turn_rate.cross(lever) + body.turn.cross(body.turn.cross(lever));
    const Eigen::Matrix3d inertia = R * inertias[b].inertia * R.transpose();
    forces[b] = inertias[b].mass * (acceleration - gravity);
    moments[b] =
        com.cross(forces[b]) + inertia * body.turn_rate + body.turn.cross(inertia * body.turn);
    result.com += inertias[b].mass * com;
    mass += inertias[b].mass;
  }
  if (mass > 0.0) result.com /= mass;
  for (const LinkWrench& wrench : wrenches) {
    forces[tree.links[wrench.link].body] -= wrench.force;
    moments[tree.links[wrench.link].body] -= wrench.moment;
  }
  result.torques = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (int k = static_cast<int>(tree.joints.size()) - 1; k >= 0; --k) {
    const Joint& joint = tree.joints[k];
    const Vector3d& centre = motion[k + 1].T_world_body.translation();
    const double torque = joint.type == JointType::kRevolute
                              ? axes[k].dot(moments[k + 1] - centre.cross(forces[k + 1]))
                              : axes[k].dot(forces[k + 1]);
    AddTorque(joint, torque, result.torques);
    forces[joint.parent_body] += forces[k + 1];
    moments[joint.parent_body] += moments[k + 1];
  }
  result.force = forces[0];
  result.moment = moments[0];
  return result;
}

Eigen::Vector3d CentreOfMass(const RobotTree& tree, const std::vector<BodyInertia>& inertias,
                             const Eigen::VectorXd& q) {
  std::vector<Transform> T_root_body(tree.body_count(), Transform::Identity());
  Vector3d moment = inertias[0].mass * inertias[0].com;
  double mass = inertias[0].mass;
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
    T_root_body[k + 1] = T_root_body[tree.joints[k].parent_body] * ParentBodyToChild(tree, k, q);
    moment += inertias[k + 1].mass * (T_root_body[k + 1] * inertias[k + 1].com);
    mass += inertias[k + 1].mass;
  }
  return mass > 0.0 ? Vector3d(moment / mass) : moment;
}

}  // namespace elastocal
