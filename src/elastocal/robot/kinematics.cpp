#include "elastocal/robot/kinematics.hpp"

#include <cmath>

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
    case Kind::kGamma: return placement.gamma;
    case Kind::kB: return placement.b;
    case Kind::kBeta: return placement.beta;
    case Kind::kAlpha: return placement.alpha;
    case Kind::kD: return placement.d;
    case Kind::kTheta: return placement.theta;
    default: return placement.r;
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

struct Frame {
  Eigen::Matrix3d R;
  Vector3d p;
};

Frame JointFrame(const Frame& parent, const Geometry::JointConstants& joint, double theta,
                 double r) {
  const Eigen::Matrix3d R_twisted = parent.R * joint.R_parent_twisted;
  const double c = std::cos(theta);
  const double s = std::sin(theta);
  Frame frame;
  frame.R.col(0) = c * R_twisted.col(0) + s * R_twisted.col(1);
  frame.R.col(1) = c * R_twisted.col(1) - s * R_twisted.col(0);
  frame.R.col(2) = R_twisted.col(2);
  frame.p = parent.p + parent.R * joint.p_parent_twisted + r * R_twisted.col(2);
  return frame;
}

/// MDH frames of the bodies in the reference frame (the root's: the root link's frame).
std::vector<Frame> MdhFrames(const ErrorModel& model, const Geometry& geometry,
                             const Eigen::VectorXd& q) {
  std::vector<Frame> frames(model.tree.body_count(),
                            {Eigen::Matrix3d::Identity(), Vector3d::Zero()});
  frames[0] = JointFrame(frames[0], geometry.base, geometry.base.theta, geometry.base.r);
  frames[0].R = frames[0].R * geometry.T_joint_waist.linear();
  for (int k : model.active_joints) {
    const Joint& joint = model.tree.joints[k];
    const Geometry::JointConstants& constants = geometry.joints[k];
    const double position = JointPosition(joint, q);
    const bool revolute = joint.type == JointType::kRevolute;
    frames[k + 1] = JointFrame(frames[joint.parent_body], constants,
                               constants.theta + (revolute ? position : 0.0),
                               constants.r + (revolute ? 0.0 : position));
  }
  return frames;
}

}  // namespace

Geometry ApplyErrors(const ErrorModel& model, const Eigen::VectorXd& delta) {
  std::vector<JointPlacement> placements = model.placements;
  Geometry geometry;
  geometry.p_joint_marker.reserve(model.markers.size());
  geometry.R_joint_link.reserve(model.markers.size());
  for (const Marker& marker : model.markers) {
    const Link& link = model.tree.links[marker.link];
    const Transform T_joint_link =
        link.body == 0 ? link.T_body_link
                       : model.placements[link.body - 1].T_joint_body * link.T_body_link;
    geometry.p_joint_marker.push_back(T_joint_link * marker.p_link_marker);
    geometry.R_joint_link.push_back(T_joint_link.linear());
  }
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.joint >= 0) {
      Constant(placements[parameter.joint], parameter.kind) += delta[i];
    } else if (parameter.marker >= 0) {
      const int coordinate = (i - (model.parameter_count() - 3 * model.marker_count())) % 3;
      geometry.p_joint_marker[parameter.marker] +=
          delta[i] * geometry.R_joint_link[parameter.marker].col(coordinate);
    }
  }
  geometry.base = MakeConstants(BasePlacement(model.T_ref_waist, delta));
  geometry.T_joint_waist = RotX(-0.5 * M_PI);
  geometry.joints.resize(model.tree.joints.size());
  for (int k : model.active_joints) geometry.joints[k] = MakeConstants(placements[k]);
  return geometry;
}

Eigen::Matrix3Xd MarkerPositions(const ErrorModel& model, const Geometry& geometry,
                                 const Eigen::VectorXd& q) {
  const std::vector<Frame> frames = MdhFrames(model, geometry, q);
  Eigen::Matrix3Xd positions(3, model.marker_count());
  for (int m = 0; m < model.marker_count(); ++m) {
    const Frame& frame = frames[model.tree.links[model.markers[m].link].body];
    positions.col(m) = frame.p + frame.R * geometry.p_joint_marker[m];
  }
  return positions;
}

std::vector<Transform> BodyTransforms(const ErrorModel& model, const Geometry& geometry,
                                      const Eigen::VectorXd& q) {
  const std::vector<Frame> frames = MdhFrames(model, geometry, q);
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
