// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/shared_support.hpp"

#include <algorithm>
#include <stdexcept>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/mdh_frames.hpp"

namespace elastocal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Transform RootByFoot(const StandingFoot& foot) {
  return foot.T_floor_foot * foot.T_root_foot.inverse(Eigen::Isometry);
}

/// The joints between the root and each foot.
std::vector<std::vector<int>> JointsOfFeet(const RobotTree& tree, const std::vector<int>& links) {
  std::vector<std::vector<int>> joints;
  for (int link : links) joints.push_back(JointsToBody(tree, tree.links[link].body));
  return joints;
}

struct MassPoint {
  double mass = 0.0;
  Vector3d centre = Vector3d::Zero();
};

MassPoint WholeMass(const RobotTree& tree, const std::vector<Transform>& T_ref_link) {
  MassPoint whole;
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    whole.mass += tree.links[i].mass;
    whole.centre += tree.links[i].mass * (T_ref_link[i] * tree.links[i].com);
  }
  if (whole.mass > 0.0) whole.centre /= whole.mass;
  return whole;
}

}  // namespace

RootOnFeet PlaceRootOnFeet(const std::vector<StandingFoot>& feet) {
  if (feet.empty()) throw std::invalid_argument("a robot without feet does not stand");
  const Matrix3d R_first = RootByFoot(feet.front()).linear();
  Vector3d mean = Vector3d::Zero();  // rotation vector from the first
  Vector3d origin = Vector3d::Zero();
  std::vector<Vector3d> from_first;
  std::vector<Matrix3d> R_floor_root;
  for (const StandingFoot& foot : feet) {
    const Transform by_foot = RootByFoot(foot);
    R_floor_root.emplace_back(by_foot.linear());
    from_first.push_back(RotationVector(by_foot.linear() * R_first.transpose()));
    mean += foot.share * from_first.back();
    origin += foot.share * by_foot.translation();
  }
  RootOnFeet root;
  root.T_floor_root.linear() = RotationFromVector(mean) * R_first;
  root.T_floor_root.translation() = origin;
  const Matrix3d left = LeftJacobian(mean);
  Matrix3d by_first = RotationFromVector(mean);
  root.by_foot.assign(feet.size(), Matrix6d::Zero());
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Matrix3d own = feet[i].share * left * InverseLeftJacobian(from_first[i]);
    by_first -= own * RotationFromVector(from_first[i]);
    // A screw [a; m] of the foot turns the root by -R a and moves its origin by -R m.
    root.by_foot[i].topLeftCorner<3, 3>() = -own * R_floor_root[i];
    root.by_foot[i].bottomRightCorner<3, 3>() = -feet[i].share * R_floor_root[i];
  }
  root.by_foot.front().topLeftCorner<3, 3>() -= by_first * R_first;
  return root;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> FootClosure(const std::vector<StandingFoot>& feet) {
  const Transform first = RootByFoot(feet.front());
  Eigen::Matrix<double, 6, Eigen::Dynamic> closure(6, static_cast<Eigen::Index>(feet.size()) - 1);
  for (Eigen::Index i = 1; i <= closure.cols(); ++i) {
    const Transform other = RootByFoot(feet[static_cast<std::size_t>(i)]);
    closure.col(i - 1) << other.translation() - first.translation(),
        RotationVector(other.linear() * first.linear().transpose());
  }
  return closure;
}

JointLoads SharedSupportLoads(const ErrorModel& model, const Geometry& geometry,
                              const Eigen::VectorXd& q, const std::vector<int>& foot_links,
                              const std::vector<StandingFoot>& feet,
                              const JointLoads& deflected_by) {
  const Transform T_floor_root = PlaceRootOnFeet(feet).T_floor_root;
  const Vector3d gravity = T_floor_root.linear().transpose() * kGravity;
  const Vector3d up = T_floor_root.linear().row(2);
  JointLoads loads = GravityLoads(model, geometry, q, gravity, 0, deflected_by);
  const MassPoint whole =
      WholeMass(model.tree, CalibratedLinkTransforms(model, geometry, q, deflected_by));
  Vector3d offset = whole.centre;
  for (const StandingFoot& foot : feet) offset -= foot.share * foot.T_root_foot.translation();
  offset -= up.dot(offset) * up;

  const std::vector<std::vector<int>> joints = JointsOfFeet(model.tree, foot_links);
  const auto visit = [&](int k, const Geometry::JointConstants& constants, const MdhFrame&,
                         const MdhFrame& twisted, const MdhFrame&) {
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (std::find(joints[i].begin(), joints[i].end(), k) == joints[i].end()) continue;
      const Vector3d force = -feet[i].share * whole.mass * gravity;
      if (model.tree.joints[k].type != JointType::kRevolute) {
        loads(2, k) += twisted.R.col(2).dot(force);
        continue;
      }
      const Vector3d centre = twisted.p + constants.centre * twisted.R.col(2);
      const Vector3d arm = feet[i].T_root_foot.translation() + offset - centre;
      loads.col(k) += twisted.R.transpose() * arm.cross(force);
    }
  };
  std::vector<MdhFrame> frames(model.tree.body_count());
  EvaluateMdhFrames(model, geometry, q, deflected_by, frames, visit);
  return loads;
}

}  // namespace elastocal
