// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/lumped_compliance.hpp"

#include <algorithm>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/mdh_frames.hpp"

namespace elastocal {

Matrix6d LumpedCompliance(const ErrorModel& model, const Geometry& geometry,
                          const Eigen::VectorXd& q, int leg) {
  const LegPosture posture = PlaceLeg(model, geometry, q, leg);
  const Transform T_foot_ref = posture.T_foot_waist * WaistPose(geometry).inverse();
  const Eigen::Vector3d p_waist = posture.T_foot_waist.translation();
  Matrix6d compliance = geometry.leg_compliance[leg].asDiagonal();

  const std::vector<int>& joints = model.legs[leg].joints;
  std::vector<MdhFrame> frames(model.tree.body_count());
  const auto visit = [&](int joint, const Geometry::JointConstants& constants, const MdhFrame&,
                         const MdhFrame& twisted, const MdhFrame&) {
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) return;
    const bool revolute = model.tree.joints[joint].type == JointType::kRevolute;
    const Eigen::Matrix3d axes = T_foot_ref.linear() * twisted.R;
    const Eigen::Vector3d centre =
        T_foot_ref * Eigen::Vector3d(twisted.p + constants.centre * twisted.R.col(2));
    // Motion of the waist by a unit rotation (translation) of the joint about each of its axes. The
    // transpose gives the load of the joint by a wrench on the waist.
    for (int axis = revolute ? 0 : 2; axis < 3; ++axis) {
      Vector6d motion = Vector6d::Zero();
      if (revolute) {
        motion << axes.col(axis).cross(p_waist - centre), axes.col(axis);
      } else {
        motion.head<3>() = axes.col(axis);
      }
      compliance += constants.compliance[axis] * motion * motion.transpose();
    }
    // The root link's own turn is about the waist's origin.
    const Eigen::Matrix3d root_axes = T_foot_ref.linear() * frames[0].R;
    compliance.bottomRightCorner<3, 3>() +=
        root_axes * constants.root_compliance.asDiagonal() * root_axes.transpose();
  };
  EvaluateMdhFrames(model, geometry, q, JointLoads(), frames, visit);
  return compliance;
}

}  // namespace elastocal
