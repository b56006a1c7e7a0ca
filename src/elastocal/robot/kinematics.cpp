// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/kinematics.hpp"

#include <cmath>

#include "elastocal/robot/mdh_frames.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;
using Eigen::Vector3d;

/// Eq. 1 up to and including Trx(d), with the axes that its derivatives need.
Geometry::JointConstants MakeConstants(const JointPlacement& placement) {
  Geometry::JointConstants constants;
  const Transform T_pre = placement.T_parent_pre;
  constants.z_pre = T_pre.linear().col(2);
  constants.p_pre = T_pre.translation();
  Transform T = T_pre * RotZ(placement.gamma) * TrZ(placement.b);
  constants.y_beta = T.linear().col(1);
  constants.p_beta = T.translation();
  T = T * RotY(placement.beta) * RotX(placement.alpha) * TrX(placement.d);
  constants.R_parent_twisted = T.linear();
  constants.p_parent_twisted = T.translation();
  constants.theta = placement.theta;
  constants.r = placement.r;
  constants.centre = placement.r + placement.T_joint_body.translation().z();
  constants.compliance.setZero();
  return constants;
}

double& Constant(JointPlacement& placement, Kind kind) {
  switch (kind) {
    case Kind::kGamma:
      return placement.gamma;
    case Kind::kB:
      return placement.b;
    case Kind::kBeta:
      return placement.beta;
    case Kind::kAlpha:
      return placement.alpha;
    case Kind::kD:
      return placement.d;
    case Kind::kTheta:
      return placement.theta;
    default:
      return placement.r;
  }
}

JointPlacement WaistPlacement(const Transform& T_ref_waist, const Vector6d& delta) {
  JointPlacement waist;
  waist.T_parent_pre = T_ref_waist;
  waist.gamma = delta[0];
  waist.b = delta[1];
  waist.alpha = 0.5 * M_PI + delta[2];
  waist.d = delta[3];
  waist.theta = delta[4];
  waist.r = delta[5];
  return waist;
}

std::vector<MdhFrame> MdhFrames(const ErrorModel& model, const Geometry& geometry,
                                const Eigen::VectorXd& q, const JointLoads& loads) {
  std::vector<MdhFrame> frames(model.tree.body_count());
  EvaluateMdhFrames(model, geometry, q, loads, frames, [](auto&&...) {});
  return frames;
}

/// Placement of a joint with its errors, which are in `delta` from index `i` on. Moves `i` behind
/// them.
Geometry::JointConstants JointWithErrors(const ErrorModel& model, int joint,
                                         const Eigen::VectorXd& delta, int& i,
                                         Eigen::VectorXd& corrections) {
  JointPlacement placement = model.placements[joint];
  Vector3d compliance = Vector3d::Zero();
  Vector3d root_compliance = Vector3d::Zero();
  for (; i < model.parameter_count() && model.parameters[i].joint == joint; ++i) {
    const Parameter& parameter = model.parameters[i];
    if (IsCompliance(parameter.kind)) {
      const bool root = parameter.axis >= kRootAxis;
      (root ? root_compliance : compliance)[parameter.axis % kRootAxis] = delta[i];
    } else if (parameter.kind == Kind::kCorrection) {
      corrections[parameter.correction] = delta[i];
    } else {
      Constant(placement, parameter.kind) += delta[i];
    }
  }
  Geometry::JointConstants constants = MakeConstants(placement);
  constants.compliance = compliance;
  constants.root_compliance = root_compliance;
  return constants;
}

/// Applies corrections that are not of a joint, which are in `delta` from index `i` on. Moves `i`
/// behind them.
void ApplyCorrections(const ErrorModel& model, const Eigen::VectorXd& delta, int& i,
                      Geometry& geometry) {
  for (; i < model.parameter_count() && model.parameters[i].kind == Kind::kCorrection; ++i) {
    if (model.parameters[i].joint >= 0) break;
    geometry.corrections[model.parameters[i].correction] = delta[i];
  }
}

/// Applies the errors of the legs, which are in `delta` from index `i` on. Moves `i` behind them.
void ApplyLegErrors(const ErrorModel& model, const Eigen::VectorXd& delta, int& i,
                    Geometry& geometry) {
  if (model.legs.empty()) return;
  geometry.leg_compliance.assign(model.legs.size(), Vector6d::Zero());
  geometry.torque_bias.setZero(static_cast<Eigen::Index>(model.tree.joints.size()));
  for (; i < model.parameter_count() && model.parameters[i].leg >= 0; ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.kind == Kind::kTorqueBias) {
      geometry.torque_bias[parameter.joint] = delta[i];
    } else {
      const int first = parameter.kind == Kind::kLegForce ? 0 : 3;
      geometry.leg_compliance[parameter.leg][first + parameter.axis] = delta[i];
    }
  }
}

/// Applies the errors of the linkages, which are in `delta` from index `i` on. Moves `i` behind
/// them.
void ApplyLinkageErrors(const ErrorModel& model, const Eigen::VectorXd& delta, int& i,
                        Geometry& geometry) {
  geometry.linkage_errors.resize(model.tree.linkages.size());
  while (i < model.parameter_count() && model.parameters[i].linkage >= 0) {
    const auto index = static_cast<std::size_t>(model.parameters[i].linkage);
    const int count = model.tree.linkages[index].error_count();
    geometry.linkage_errors[index] = delta.segment(i, count);
    i += count;
  }
}

}  // namespace

Geometry ApplyErrors(const ErrorModel& model, const Eigen::VectorXd& delta) {
  Geometry geometry;
  PlaceWaist(model.T_ref_waist, delta.head<kWaistParameterCount>(), geometry);
  geometry.T_joint_waist = RotX(-0.5 * M_PI);
  geometry.joints.resize(model.tree.joints.size());
  geometry.corrections.setZero(static_cast<Eigen::Index>(model.elasticity.corrections.size()));
  int i = kWaistParameterCount;
  ApplyCorrections(model, delta, i, geometry);
  for (int k : model.active_joints) {
    geometry.joints[k] = JointWithErrors(model, k, delta, i, geometry.corrections);
  }
  ApplyLegErrors(model, delta, i, geometry);
  ApplyLinkageErrors(model, delta, i, geometry);
  ApplyCorrections(model, delta, i, geometry);
  geometry.p_joint_marker.reserve(model.markers.size());
  geometry.R_joint_link.reserve(model.markers.size());
  for (const Marker& marker : model.markers) {
    const Link& link = model.tree.links[marker.link];
    const Transform T_joint_link =
        link.body == 0 ? link.T_body_link
                       : model.placements[link.body - 1].T_joint_body * link.T_body_link;
    geometry.p_joint_marker.push_back(T_joint_link * (marker.p_link_marker + delta.segment<3>(i)));
    geometry.R_joint_link.emplace_back(T_joint_link.linear());
    i += 3;
  }
  return geometry;
}

void PlaceWaist(const Transform& T_ref_waist, const Vector6d& t0_errors, Geometry& geometry) {
  geometry.waist = MakeConstants(WaistPlacement(T_ref_waist, t0_errors));
}

Transform WaistPose(const Geometry& geometry) {
  Transform T_ref_twisted = Transform::Identity();
  T_ref_twisted.linear() = geometry.waist.R_parent_twisted;
  T_ref_twisted.translation() = geometry.waist.p_parent_twisted;
  return T_ref_twisted * RotZ(geometry.waist.theta) * TrZ(geometry.waist.r) *
         geometry.T_joint_waist;
}

Eigen::Matrix3Xd MarkerPositions(const ErrorModel& model, const Geometry& geometry,
                                 const Eigen::VectorXd& q, const JointLoads& loads) {
  const std::vector<MdhFrame> frames = MdhFrames(model, geometry, q, loads);
  Eigen::Matrix3Xd positions(3, model.marker_count());
  for (int m = 0; m < model.marker_count(); ++m) {
    const MdhFrame& frame = frames[model.tree.links[model.markers[m].link].body];
    positions.col(m) = frame.p + frame.R * MarkerInBody(model, geometry, loads, m);
  }
  return positions;
}

JointLoads CorrectedLoads(const Geometry& geometry, const JointLoads& loads) {
  JointLoads corrected = loads;
  corrected.by_correction.clear();
  for (std::size_t i = 0; i < loads.by_correction.size(); ++i) {
    const Eigen::Matrix3Xd& derivative = loads.by_correction[i];
    if (derivative.cols() == 0) continue;
    corrected += geometry.corrections[static_cast<Eigen::Index>(i)] * derivative;
  }
  return corrected;
}

JointLoads TurnedLoads(const ErrorModel& model, const Geometry& before, const Geometry& after,
                       const JointLoads& loads) {
  JointLoads turned = loads;
  if (loads.cols() == 0) return turned;
  const auto about_z = [](double angle) {
    return Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
  };
  for (const int k : model.active_joints) {
    const Joint& joint = model.tree.joints[k];
    if (joint.parent_body != 0) continue;
    const Geometry::JointConstants& from = before.joints[k];
    const Geometry::JointConstants& to = after.joints[k];
    const Eigen::Matrix3d own = about_z(to.theta - from.theta);
    if (joint.type == JointType::kRevolute) {
      turned.col(k) = own * loads.col(k);
      for (Eigen::Matrix3Xd& derivative : turned.by_correction) {
        if (derivative.cols() > 0) derivative.col(k) = own * derivative.col(k);
      }
    }
    if (loads.about_root.cols() > 0) {
      turned.about_root.col(k) =
          to.R_parent_twisted * own * from.R_parent_twisted.transpose() * loads.about_root.col(k);
    }
  }
  return turned;
}

Vector3d MarkerInBody(const ErrorModel& model, const Geometry& geometry, const JointLoads& loads,
                      int marker) {
  Vector3d position = geometry.p_joint_marker[marker];
  if (loads.shapes.size() == 0) return position;
  const std::vector<Correction>& all = model.elasticity.corrections;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (all[i].marker != marker) continue;
    position += geometry.corrections[at] * loads.shapes[at] *
                geometry.R_joint_link[marker].col(all[i].axis);
  }
  return position;
}

MarkerInLink PlaceMarker(const ErrorModel& model, const Geometry& geometry, int marker, int link) {
  const Link& on = model.tree.links[link];
  const Transform T_joint_link =
      on.body == 0 ? on.T_body_link : model.placements[on.body - 1].T_joint_body * on.T_body_link;
  const Transform T_link_joint = T_joint_link.inverse();
  return {T_link_joint * geometry.p_joint_marker[marker],
          T_link_joint.linear() * geometry.R_joint_link[marker]};
}

std::vector<Transform> BodyTransforms(const ErrorModel& model, const Geometry& geometry,
                                      const Eigen::VectorXd& q, const JointLoads& loads) {
  const std::vector<MdhFrame> frames = MdhFrames(model, geometry, q, loads);
  std::vector<Transform> T_ref_body(frames.size(), Transform::Identity());
  const auto set = [&](int body, const Transform& T_joint_body) {
    T_ref_body[body].linear() = frames[body].R;
    T_ref_body[body].translation() = frames[body].p;
    T_ref_body[body] = T_ref_body[body] * T_joint_body;
  };
  set(0, Transform::Identity());
  for (int k : model.active_joints) set(k + 1, model.placements[k].T_joint_body);
  return T_ref_body;
}

std::vector<Transform> CalibratedLinkTransforms(const ErrorModel& model, const Geometry& geometry,
                                                const Eigen::VectorXd& q, const JointLoads& loads) {
  const RobotTree& tree = model.tree;
  std::vector<Transform> T_ref_body = BodyTransforms(model, geometry, q, loads);
  auto active = model.active_joints.begin();
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
    if (active != model.active_joints.end() && *active == k) {
      ++active;
    } else {
      T_ref_body[k + 1] = T_ref_body[tree.joints[k].parent_body] * ParentBodyToChild(tree, k, q);
    }
  }
  return LinkTransforms(tree, T_ref_body);
}

}  // namespace elastocal
