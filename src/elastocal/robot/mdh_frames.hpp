#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Pose of an MDH frame (see placement.hpp) in the reference frame.
struct MdhFrame {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
};

inline constexpr int kWaist = -1;  ///< stands for eq. 2 where otherwise a joint's index is

/// Walks along the tree from the reference frame outwards (eq. 3) and fills `frames` (one a body):
/// the root link's frame and the MDH frames that active joints move. At the waist and at each joint
/// it calls
///
///   visit(joint or kWaist, its constants, parent frame, twisted frame)
///
/// where the twisted frame is the one after Trx(d) in eq. 1: its x is the axis of alpha and d, its
/// z that of theta and r. Forward kinematics and the Jacobian are the same walk.
template <typename Visit>
inline void EvaluateMdhFrames(const ErrorModel& model, const Geometry& geometry,
                              const Eigen::VectorXd& q, std::vector<MdhFrame>& frames,
                              const Visit& visit) {
  const auto place = [&](int joint, const Geometry::JointConstants& constants,
                         const MdhFrame& parent, double theta, double r, MdhFrame& frame) {
    const MdhFrame twisted{parent.R * constants.R_parent_twisted,
                           parent.p + parent.R * constants.p_parent_twisted};
    visit(joint, constants, parent, twisted);
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    frame.R.col(0) = c * twisted.R.col(0) + s * twisted.R.col(1);
    frame.R.col(1) = c * twisted.R.col(1) - s * twisted.R.col(0);
    frame.R.col(2) = twisted.R.col(2);
    frame.p = twisted.p + r * twisted.R.col(2);
  };
  const MdhFrame reference{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  place(kWaist, geometry.base, reference, geometry.base.theta, geometry.base.r, frames[0]);
  frames[0].R = frames[0].R * geometry.T_joint_waist.linear();
  for (int k : model.active_joints) {
    const Joint& joint = model.tree.joints[k];
    const Geometry::JointConstants& constants = geometry.joints[k];
    const double position = JointPosition(joint, q);
    const bool revolute = joint.type == JointType::kRevolute;
    place(k, constants, frames[joint.parent_body], constants.theta + (revolute ? position : 0.0),
          constants.r + (revolute ? 0.0 : position), frames[k + 1]);
  }
}

}  // namespace elastocal
