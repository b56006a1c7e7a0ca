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

JointPlacement BasePlacement(const Transform& T_ref_waist, const Eigen::VectorXd& delta) {
  JointPlacement base;
  base.T_parent_pre = T_ref_waist;
  base.gamma = delta[0];
  base.b = delta[1];
  base.alpha = 0.5 * M_PI + delta[2];
  base.d = delta[3];
  base.theta = delta[4];
  base.r = delta[5];
  return base;
}

std::vector<MdhFrame> MdhFrames(const ErrorModel& model, const Geometry& geometry,
                                const Eigen::VectorXd& q) {
  std::vector<MdhFrame> frames(model.tree.body_count());
  EvaluateMdhFrames(model, geometry, q, frames, [](auto&&...) {});
  return frames;
}

}  // namespace

Geometry ApplyErrors(const ErrorModel& model, const Eigen::VectorXd& delta) {
  Geometry geometry;
  geometry.base = MakeConstants(BasePlacement(model.T_ref_waist, delta));
  geometry.T_joint_waist = RotX(-0.5 * M_PI);
  geometry.joints.resize(model.tree.joints.size());
  int i = kBaseParameterCount;
  for (int k : model.active_joints) {
    JointPlacement placement = model.placements[k];
    for (; i < model.parameter_count() && model.parameters[i].joint == k; ++i) {
      Constant(placement, model.parameters[i].kind) += delta[i];
    }
    geometry.joints[k] = MakeConstants(placement);
  }
  geometry.p_joint_marker.reserve(model.markers.size());
  geometry.R_joint_link.reserve(model.markers.size());
  for (const Marker& marker : model.markers) {
    const Link& link = model.tree.links[marker.link];
    const Transform T_joint_link =
        link.body == 0 ? link.T_body_link
                       : model.placements[link.body - 1].T_joint_body * link.T_body_link;
    geometry.p_joint_marker.push_back(T_joint_link * (marker.p_link_marker + delta.segment<3>(i)));
    geometry.R_joint_link.push_back(T_joint_link.linear());
    i += 3;
  }
  return geometry;
}

Eigen::Matrix3Xd MarkerPositions(const ErrorModel& model, const Geometry& geometry,
                                 const Eigen::VectorXd& q) {
  const std::vector<MdhFrame> frames = MdhFrames(model, geometry, q);
  Eigen::Matrix3Xd positions(3, model.marker_count());
  for (int m = 0; m < model.marker_count(); ++m) {
    const MdhFrame& frame = frames[model.tree.links[model.markers[m].link].body];
    positions.col(m) = frame.p + frame.R * geometry.p_joint_marker[m];
  }
  return positions;
}

std::vector<Transform> BodyTransforms(const ErrorModel& model, const Geometry& geometry,
                                      const Eigen::VectorXd& q) {
  const std::vector<MdhFrame> frames = MdhFrames(model, geometry, q);
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

}  // namespace elastocal
