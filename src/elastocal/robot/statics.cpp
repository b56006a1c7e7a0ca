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

/// Load of a joint by what it carries, see JointLoads. `centre`: z of the joint's physical centre
/// in its twisted frame, m.
Vector3d LoadOn(JointType type, const CarriedLoad& carried, double centre, const MdhFrame& twisted,
                const Vector3d& gravity) {
  const Vector3d axis = twisted.R.col(2);
  if (type == JointType::kPrismatic) {
    return {0.0, 0.0, carried.side * carried.mass * axis.dot(gravity)};
  }
  return twisted.R.transpose() * TurningMoment(carried, twisted.p + centre * axis, gravity);
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

Eigen::VectorXd LargestGravityTorques(const RobotTree& tree) {
  const std::vector<Transform> T_root_link =
      LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const std::vector<CarriedLoad> loads = CarriedLoads(tree, T_root_link, 0);
  Eigen::VectorXd torques(static_cast<Eigen::Index>(loads.size()));
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Vector3d& joint =
        T_root_link[static_cast<std::size_t>(tree.joints[k].child_link)].translation();
    const double lever = tree.joints[k].type == JointType::kPrismatic
                             ? loads[k].mass
                             : (loads[k].moment - loads[k].mass * joint).norm();
    torques[static_cast<Eigen::Index>(k)] = lever * kGravity.norm();
  }
  return torques;
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
    loads.col(k) =
        LoadOn(model.tree.joints[k].type, carried[k], constants.centre, twisted, gravity_ref);
  };
  EvaluateMdhFrames(model, geometry, q, deflected_by, frames, visit);
  return loads;
}

namespace {

/// Corrections of loads that are parameters of the model.
std::vector<int> CorrectionsOfLoads(const ErrorModel& model) {
  std::vector<int> corrections;
  for (const Parameter& parameter : model.parameters) {
    if (parameter.kind != ParameterKind::kCorrection) continue;
    const auto index = static_cast<std::size_t>(parameter.correction);
    if (TargetOf(model.elasticity.corrections[index]) != CorrectionTarget::kLoads) continue;
    corrections.push_back(parameter.correction);
  }
  return corrections;
}

/// Mass and first moment that one unit of a correction adds to its body.
CarriedLoad AddedLoad(const RobotTree& tree, const Correction& correction,
                      const std::vector<Transform>& T_ref_link) {
  if (correction.shape == CorrectionShape::kFirstMoment) {
    const int link = tree.joints[correction.source].child_link;
    return {0.0, T_ref_link[link].linear().col(correction.axis)};
  }
  CarriedLoad body;
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const Link& link = tree.links[i];
    if (link.body != correction.source + 1) continue;
    body.mass += link.mass;
    body.moment += link.mass * (T_ref_link[i] * link.com);
  }
  return {1.0, body.moment / body.mass};
}

}  // namespace

std::vector<Eigen::Matrix3Xd> LoadsByCorrections(const ErrorModel& model, const Geometry& geometry,
                                                 const Eigen::VectorXd& q,
                                                 const Vector3d& gravity_ref) {
  const std::vector<int> corrections = CorrectionsOfLoads(model);
  if (corrections.empty()) return {};
  std::vector<Eigen::Matrix3Xd> derivatives(model.elasticity.corrections.size());
  const std::vector<Transform> T_ref_link = CalibratedLinkTransforms(model, geometry, q);
  std::vector<MdhFrame> frames(model.tree.body_count());
  for (int i : corrections) {
    const Correction& correction = model.elasticity.corrections[i];
    const bool tilt = correction.shape == CorrectionShape::kGravityTilt;
    std::vector<CarriedLoad> carried;
    std::vector<int> joints = model.active_joints;
    Vector3d gravity = gravity_ref;
    if (tilt) {
      carried = CarriedLoads(model.tree, T_ref_link, 0);
      gravity = Vector3d(WaistPose(geometry).linear().col(correction.axis)).cross(gravity_ref);
    } else {
      carried.assign(model.tree.joints.size(), AddedLoad(model.tree, correction, T_ref_link));
      joints = JointsToBody(model.tree, correction.source + 1);
    }
    derivatives[i].setZero(3, static_cast<Eigen::Index>(model.tree.joints.size()));
    EvaluateMdhFrames(model, geometry, q, {}, frames,
                      [&](int k, const Geometry::JointConstants& constants, const MdhFrame&,
                          const MdhFrame& twisted, const MdhFrame&) {
                        if (std::find(joints.begin(), joints.end(), k) == joints.end()) return;
                        derivatives[i].col(k) = LoadOn(model.tree.joints[k].type, carried[k],
                                                       constants.centre, twisted, gravity);
                      });
  }
  return derivatives;
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
