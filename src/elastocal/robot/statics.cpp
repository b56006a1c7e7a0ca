// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/statics.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/robot/mdh_frames.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// Moment about `point` of the weight that a joint carries, by which it turns the child, N.m.
Vector3d TurningMoment(const CarriedLoad& carried, const Vector3d& point, const Vector3d& gravity) {
  return carried.side * (carried.moment - carried.mass * point).cross(gravity);
}

}  // namespace

std::vector<CarriedLoad> CarriedLoads(const RobotTree& tree,
                                      const std::vector<Transform>& T_ref_link, int fixed_link) {
  // The load of each body, and then of all bodies beyond it too.
  std::vector<CarriedLoad> beyond(tree.body_count());
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const Link& link = tree.links[i];
    beyond[link.body].mass += link.mass;
    beyond[link.body].moment += link.mass * (T_ref_link[i] * link.com);
  }
  for (int k = static_cast<int>(tree.joints.size()) - 1; k >= 0; --k) {
    CarriedLoad& parent = beyond[tree.joints[k].parent_body];
    parent.mass += beyond[k + 1].mass;
    parent.moment += beyond[k + 1].moment;
  }
  const CarriedLoad all = beyond.front();
  for (int k : JointsToBody(tree, tree.links[fixed_link].body)) {
    CarriedLoad& load = beyond[k + 1];
    load = {all.mass - load.mass, all.moment - load.moment, -1};
  }
  beyond.erase(beyond.begin());
  return beyond;
}

Eigen::VectorXd StaticTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                              const Vector3d& gravity_waist, int fixed_link) {
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
  const std::vector<CarriedLoad> carried = CarriedLoads(tree, T_root_link, fixed_link);
  Eigen::VectorXd torques = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const Transform& T_root_child = T_root_link[joint.child_link];
    const Vector3d axis = T_root_child.linear() * joint.axis;
    const Vector3d load = joint.type == JointType::kRevolute
                              ? TurningMoment(carried[k], T_root_child.translation(), gravity_waist)
                              : Vector3d(carried[k].side * carried[k].mass * gravity_waist);
    AddTorque(joint, -axis.dot(load), torques);
  }
  return torques;
}

Eigen::VectorXd GravityTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                               const Vector3d& gravity_waist) {
  return StaticTorques(tree, q, gravity_waist, 0);
}

JointLoads GravityLoads(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        const Vector3d& gravity_ref, int fixed_link,
                        const JointLoads& deflected_by) {
  const std::vector<CarriedLoad> carried = CarriedLoads(
      model.tree, CalibratedLinkTransforms(model, geometry, q, deflected_by), fixed_link);
  JointLoads loads = JointLoads::Zero(3, static_cast<Eigen::Index>(model.tree.joints.size()));
  std::vector<MdhFrame> frames(model.tree.body_count());
  const std::vector<int>& bent = model.elasticity.root_bending;
  if (!bent.empty()) loads.about_root.setZero(3, loads.cols());
  const auto visit = [&](int k, const Geometry::JointConstants& constants, const MdhFrame&,
                         const MdhFrame& twisted, const MdhFrame&) {
    if (k == kWaist) return;
    if (std::find(bent.begin(), bent.end(), k) != bent.end()) {
      loads.about_root.col(k) =
          frames[0].R.transpose() * TurningMoment(carried[k], frames[0].p, gravity_ref);
    }
    if (model.tree.joints[k].type == JointType::kRevolute) {
      const Vector3d centre = twisted.p + constants.centre * twisted.R.col(2);
      loads.col(k) = twisted.R.transpose() * TurningMoment(carried[k], centre, gravity_ref);
    } else {
      loads(2, k) = carried[k].side * carried[k].mass * twisted.R.col(2).dot(gravity_ref);
    }
  };
  EvaluateMdhFrames(model, geometry, q, deflected_by, frames, visit);
  return loads;
}

void UseMeasuredTorques(const Eigen::VectorXd& torques, JointLoads& loads) {
  for (Eigen::Index k = 0; k < torques.size(); ++k) {
    if (!std::isnan(torques[k])) loads(2, k) = -torques[k];
  }
}

double TotalMass(const RobotTree& tree) {
  double mass = 0.0;
  for (const Link& link : tree.links) mass += link.mass;
  return mass;
}

}  // namespace elastocal
