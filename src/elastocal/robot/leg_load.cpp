// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/leg_load.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

constexpr double kSingular = 1e-12;  // of the largest singular value

/// For each body, whether it is `body` or beyond it.
std::vector<bool> BodiesBeyond(const RobotTree& tree, int body) {
  std::vector<bool> beyond(tree.body_count(), false);
  beyond[body] = true;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (beyond[tree.joints[k].parent_body]) beyond[k + 1] = true;
  }
  return beyond;
}

/// The bodies of the leg: those beyond its first joint, but not another leg that hangs on it behind
/// a joint that both share.
std::vector<bool> LegBodies(const ErrorModel& model, const LegPosture& posture) {
  const std::vector<int>& joints = model.legs[posture.leg].joints;
  std::vector<bool> bodies = BodiesBeyond(model.tree, joints.front() + 1);
  for (const SupportLeg& other : model.legs) {
    const auto apart = std::find_if(other.joints.begin(), other.joints.end(), [&](int joint) {
      return std::find(joints.begin(), joints.end(), joint) == joints.end();
    });
    if (apart == other.joints.end()) continue;
    const std::vector<bool> of_other = BodiesBeyond(model.tree, *apart + 1);
    for (std::size_t body = 0; body < bodies.size(); ++body) {
      if (of_other[body]) bodies[body] = false;
    }
  }
  return bodies;
}

Eigen::Matrix3d FootAxes(const ErrorModel& model, const LegPosture& posture) {
  return posture.T_ref_link[model.legs[posture.leg].link].linear().transpose();
}

/// Weight of all links whose body fulfils `counts(body)`, as a wrench at the waist's origin in the
/// axes of the foot.
template <typename Counts>
Vector6d Weight(const ErrorModel& model, const LegPosture& posture, const Vector3d& gravity_ref,
                const Counts& counts) {
  const Vector3d p_ref_waist = posture.T_ref_link.front().translation();
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
  for (std::size_t i = 0; i < model.tree.links.size(); ++i) {
    const Link& link = model.tree.links[i];
    if (!counts(link.body)) continue;
    const Vector3d weight = link.mass * gravity_ref;
    force += weight;
    moment += (posture.T_ref_link[i] * link.com - p_ref_waist).cross(weight);
  }
  const Eigen::Matrix3d R_foot_ref = FootAxes(model, posture);
  Vector6d wrench;
  wrench << R_foot_ref * force, R_foot_ref * moment;
  return wrench;
}

/// Weight that a section of the leg carries in addition to the load on the waist: that of the leg's
/// own links above the section, less that of another leg that hangs on the leg below the section.
/// `beyond` marks the bodies on the foot's side.
Vector6d WeightBesideLoad(const ErrorModel& model, const LegPosture& posture,
                          const Vector3d& gravity_ref, const std::vector<bool>& of_leg,
                          const std::vector<bool>& beyond) {
  return Weight(model, posture, gravity_ref,
                [&](int body) { return of_leg[body] && !beyond[body]; }) -
         Weight(model, posture, gravity_ref,
                [&](int body) { return !of_leg[body] && beyond[body]; });
}

}  // namespace

LegPosture PlaceLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                    int leg, const JointLoads& loads) {
  const SupportLeg& support = model.legs[leg];
  LegPosture posture;
  posture.leg = leg;
  posture.T_ref_link = CalibratedLinkTransforms(model, geometry, q, loads);
  const Transform& T_ref_waist = posture.T_ref_link.front();
  const Transform& T_ref_foot = posture.T_ref_link[support.link];
  posture.T_foot_waist = T_ref_foot.inverse() * T_ref_waist;
  posture.J_waist_q.resize(6, static_cast<Eigen::Index>(support.joints.size()));
  for (std::size_t i = 0; i < support.joints.size(); ++i) {
    // With the foot fixed, the joint moves the waist's side, in the opposite direction.
    const Joint& joint = model.tree.joints[support.joints[i]];
    const Transform& T_ref_child = posture.T_ref_link[joint.child_link];
    const Vector3d axis = T_ref_child.linear() * joint.axis;
    const Vector3d lever = T_ref_waist.translation() - T_ref_child.translation();
    const bool revolute = joint.type == JointType::kRevolute;
    const Vector3d translation = revolute ? Vector3d(-axis.cross(lever)) : Vector3d(-axis);
    const Vector3d rotation = revolute ? Vector3d(-axis) : Vector3d::Zero();
    posture.J_waist_q.col(static_cast<Eigen::Index>(i))
        << T_ref_foot.linear().transpose() * translation,
        T_ref_foot.linear().transpose() * rotation;
  }
  return posture;
}

LegLoad LoadFromTorques(const LegPosture& posture, const Eigen::VectorXd& leg_torques,
                        const LegLoadOptions& options) {
  // tau = -J^T F = -(S J)^T (S^-1 F), where S divides translations by the length.
  Vector6d scale = Vector6d::Ones();
  scale.head<3>() /= options.length_scale;
  const Eigen::MatrixXd scaled_transpose = posture.J_waist_q.transpose() * scale.asDiagonal();
  const SingularValueDecomposition svd = DecomposeSingular(scaled_transpose);
  const Eigen::VectorXd& sigma = svd.values;
  const double floor = kSingular * sigma[0];
  const Eigen::VectorXd inverse =
      sigma.unaryExpr([&](double s) { return s > floor ? 1.0 / s : 0.0; });
  const double smallest = sigma.tail<1>()[0];

  LegLoad load;
  load.condition = smallest > floor ? sigma[0] / smallest : std::numeric_limits<double>::infinity();
  load.wrench_by_torque = scale.asDiagonal() * svd.V * (-inverse).asDiagonal() * svd.U.transpose();
  load.wrench = load.wrench_by_torque * leg_torques;
  if (!leg_torques.allFinite()) {
    load.status = LegLoadStatus::kIncomplete;
    load.wrench.setConstant(std::numeric_limits<double>::quiet_NaN());
  } else if (!(load.condition <= options.max_condition)) {
    load.status = LegLoadStatus::kBadlyConditioned;
  }
  return load;
}

Eigen::VectorXd LegWeightTorques(const ErrorModel& model, const LegPosture& posture,
                                 const Vector3d& gravity_ref) {
  const std::vector<int>& joints = model.legs[posture.leg].joints;
  const std::vector<bool> of_leg = LegBodies(model, posture);
  Eigen::VectorXd torques(static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index i = 0; i < torques.size(); ++i) {
    const Vector6d weight = WeightBesideLoad(model, posture, gravity_ref, of_leg,
                                             BodiesBeyond(model.tree, joints[i] + 1));
    torques[i] = -posture.J_waist_q.col(i).dot(weight);
  }
  return torques;
}

Vector6d LoadFromWrench(const ErrorModel& model, const LegPosture& posture, int sensor_link,
                        const Vector6d& measured, const Vector3d& gravity_ref) {
  const std::vector<bool> of_leg = LegBodies(model, posture);
  const int sensor_body = model.tree.links[sensor_link].body;
  if (!of_leg[sensor_body]) {
    throw std::invalid_argument("the force sensor at '" + model.tree.links[sensor_link].name +
                                "' is not on leg '" + model.legs[posture.leg].name + "'");
  }
  const Transform T_foot_sensor =
      posture.T_ref_link[model.legs[posture.leg].link].inverse() * posture.T_ref_link[sensor_link];
  const Vector3d force = T_foot_sensor.linear() * measured.head<3>();
  const Vector3d lever = T_foot_sensor.translation() - posture.T_foot_waist.translation();
  Vector6d at_waist;
  at_waist << force, T_foot_sensor.linear() * measured.tail<3>() + lever.cross(force);
  return -at_waist - WeightBesideLoad(model, posture, gravity_ref, of_leg,
                                      BodiesBeyond(model.tree, sensor_body));
}

Vector6d LoadFromStatics(const ErrorModel& model, const LegPosture& posture,
                         const Vector3d& gravity_ref) {
  const std::vector<bool> of_leg = LegBodies(model, posture);
  return Weight(model, posture, gravity_ref, [&](int body) { return !of_leg[body]; });
}

WaistDeflection DeflectWaist(const Transform& T_foot_waist, const Vector6d& compliance,
                             const Vector6d& wrench) {
  const Vector6d displacement = compliance.cwiseProduct(wrench);
  const Vector3d phi = displacement.tail<3>();
  WaistDeflection deflection;
  deflection.T_foot_waist = T_foot_waist;
  deflection.T_foot_waist.translation() += displacement.head<3>();
  deflection.T_foot_waist.linear() = RotationFromVector(phi) * T_foot_waist.linear();
  Matrix6d motion = Matrix6d::Identity();
  motion.bottomRightCorner<3, 3>() = LeftJacobian(phi);
  deflection.by_compliance = motion * wrench.asDiagonal();
  deflection.by_wrench = motion * compliance.asDiagonal();
  return deflection;
}

}  // namespace elastocal
