// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/posture_loads.hpp"

#include <cmath>

#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

/// Torques of the leg's joints: measured, or by statics for a joint without sensor.
Eigen::VectorXd LegTorques(const SupportLeg& leg, const Eigen::VectorXd& measured,
                           const JointLoads& gravity, std::vector<int>& without) {
  Eigen::VectorXd torques(static_cast<Eigen::Index>(leg.joints.size()));
  for (Eigen::Index i = 0; i < torques.size(); ++i) {
    const int joint = leg.joints[static_cast<std::size_t>(i)];
    const bool sensed = measured.size() > 0 && std::isfinite(measured[joint]);
    torques[i] = sensed ? measured[joint] : -gravity(2, joint);
    if (!sensed) without.push_back(joint);
  }
  return torques;
}

/// Moment of the weight of all links about the origin of the root link, in its axes, N.m.
Eigen::Vector3d RootMoment(const ErrorModel& model, const Geometry& geometry,
                           const Eigen::VectorXd& q, const Eigen::Vector3d& gravity_ref,
                           const JointLoads& deflected_by) {
  const std::vector<Transform> T_ref_link =
      CalibratedLinkTransforms(model, geometry, q, deflected_by);
  const Transform T_ref_root = WaistPose(geometry);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < model.tree.links.size(); ++i) {
    const Link& link = model.tree.links[i];
    const Eigen::Vector3d arm = T_ref_link[i] * link.com - T_ref_root.translation();
    moment += arm.cross(link.mass * gravity_ref);
  }
  return T_ref_root.linear().transpose() * moment;
}

void LoadWaist(const ErrorModel& model, const LegPosture& posture, const MeasuredLoads& measured,
               const JointLoads& gravity, const Eigen::Vector3d& gravity_ref,
               const LoadOptions& options, PostureLoads& loads) {
  const SupportLeg& leg = model.legs[posture.leg];
  loads.waist_by_bias.setZero(6, static_cast<Eigen::Index>(leg.joints.size()));
  if (options.source == LoadSource::kWrench && measured.wrench_link >= 0) {
    loads.waist =
        LoadFromWrench(model, posture, measured.wrench_link, measured.wrench, gravity_ref);
    return;
  }
  loads.waist = LoadFromStatics(model, posture, gravity_ref);
  if (options.source == LoadSource::kStatics) return;
  const Eigen::VectorXd torques =
      LegTorques(leg, measured.torques, gravity, loads.without_torques) -
      LegWeightTorques(model, posture, gravity_ref);
  const LegLoad load =
      LoadFromTorques(posture, torques, {.max_condition = options.largest_condition});
  loads.badly_conditioned = load.status != LegLoadStatus::kReliable;
  if (loads.badly_conditioned) return;
  loads.waist = load.wrench;
  loads.waist_by_bias = -load.wrench_by_torque;
}

/// Sets the derivatives of the loads by corrections. A load from a measured torque does not depend
/// on the masses.
void AddByCorrections(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                      const MeasuredLoads& measured, const Eigen::Vector3d& gravity_ref,
                      JointLoads& loads) {
  loads.by_correction = LoadsByCorrections(model, geometry, q, gravity_ref);
  for (Eigen::Matrix3Xd& derivative : loads.by_correction) {
    if (derivative.cols() == 0) continue;
    for (Eigen::Index k = 0; k < measured.torques.size(); ++k) {
      if (!std::isnan(measured.torques[k])) derivative(2, k) = 0.0;
    }
  }
}

}  // namespace

Vector6d PostureLoads::WaistLoad(const ErrorModel& model, const Geometry& geometry, int leg) const {
  if (waist_by_bias.cols() == 0) return waist;
  return waist + waist_by_bias * geometry.torque_bias(model.legs[leg].joints);
}

PostureLoads LoadPosture(const ErrorModel& model, const Geometry& geometry,
                         const Eigen::VectorXd& q, int leg, const MeasuredLoads& measured,
                         const Eigen::Vector3d& gravity_ref, const LoadOptions& options) {
  PostureLoads loads;
  JointLoads gravity;
  for (int step = 0; step < 2; ++step) {  // first of the rigid, then of the deflected robot
    gravity = GravityLoads(model, geometry, q, gravity_ref, leg < 0 ? 0 : model.legs[leg].link,
                           loads.joints);
    loads.joints = gravity;
    if (measured.torques.size() > 0) UseMeasuredTorques(measured.torques, loads.joints);
  }
  if (leg < 0) {
    AddByCorrections(model, geometry, q, measured, gravity_ref, loads.joints);
    return loads;
  }
  const LegPosture posture = PlaceLeg(model, geometry, q, leg, loads.joints);
  LoadWaist(model, posture, measured, gravity, gravity_ref, options, loads);
  if (loads.joints.about_root.cols() > 0) {  // the waist turns the leg by the opposite
    loads.joints.about_root.col(model.legs[leg].joints.front()) =
        -(posture.T_foot_waist.linear().transpose() * loads.waist.tail<3>());
  }
  return loads;
}

void AddShapes(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
               const Eigen::Vector3d& gravity_ref, PostureHistory history, JointLoads& loads) {
  history.root_moment = RootMoment(model, geometry, q, gravity_ref, loads);
  loads.shapes = EvaluateShapes(model.tree, model.elasticity.corrections, q,
                                CorrectedLoads(geometry, loads).row(2).transpose(), history);
}

}  // namespace elastocal
