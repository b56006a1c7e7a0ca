// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage_errors.hpp"

namespace elastocal {

/// Pose of an MDH frame (see placement.hpp) in the reference frame.
struct MdhFrame {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
};

inline constexpr int kWaist = -1;  ///< in place of a joint's index: the waist (eq. 2)

/// The twisted frame of a joint after its elastic rotation phi = compliance .* load, which is
/// Exp(phi) about its physical centre. A prismatic joint moves along z instead.
inline MdhFrame Deflected(const Geometry::JointConstants& constants, bool revolute,
                          const Eigen::Vector3d& load, const MdhFrame& twisted) {
  const Eigen::Vector3d phi = constants.compliance.cwiseProduct(load);
  if (!revolute) return {twisted.R, twisted.p + phi.z() * twisted.R.col(2)};
  MdhFrame deflected;
  deflected.R = twisted.R * RotationFromVector(phi);
  deflected.p = twisted.p + constants.centre * (twisted.R.col(2) - deflected.R.col(2));
  return deflected;
}

/// The root link's frame for a joint on it, if the root link bends up to this joint: turned about
/// its origin by the compliance times `moment`.
inline MdhFrame BentRoot(const Geometry::JointConstants& constants, const Eigen::Vector3d& moment,
                         const MdhFrame& root) {
  return {root.R * RotationFromVector(constants.root_compliance.cwiseProduct(moment)), root.p};
}

/// Expresses loads that were computed with the constants `before` for a robot with the constants
/// `after`. The loads of joints on the root link stay the same in the axes of what the joint
/// carries. If only the root link's frame is displaced (gauge.hpp), what the joint carries stays
/// where it was in the room, and so does its load. If the loads were kept in the root link's axes
/// instead, they would seem to tell where that frame is.
JointLoads TurnedLoads(const ErrorModel& model, const Geometry& before, const Geometry& after,
                       const JointLoads& loads);

/// Sum of the corrections that displace a joint's position, rad or m.
inline double PositionCorrection(const ErrorModel& model, const Geometry& geometry,
                                 const JointLoads& loads, int joint) {
  double sum = 0.0;
  const std::vector<Correction>& all = model.elasticity.corrections;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (all[i].joint == joint) sum += geometry.corrections[at] * loads.shapes[at];
  }
  return sum;
}

/// Displacement of the root link by corrections, in its axes: translation, then rotation vector.
inline Vector6d RootCorrection(const ErrorModel& model, const Geometry& geometry,
                               const JointLoads& loads) {
  Vector6d sum = Vector6d::Zero();
  const std::vector<Correction>& all = model.elasticity.corrections;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (TargetOf(all[i]) != CorrectionTarget::kRoot) continue;
    sum[all[i].axis] += geometry.corrections[at] * loads.shapes[at];
  }
  return sum;
}

/// Walks along the tree from the reference frame outwards (eq. 3) and fills `frames` (one for each
/// body): the root link's frame and the MDH frames that active joints move. At the waist and at
/// each joint it calls
///
///   visit(joint or kWaist, its constants, parent frame, twisted frame, deflected frame)
///
/// where the twisted frame is the one after Trx(d) in eq. 1: its x is the axis of alpha and d, its
/// z the joint's axis. The deflected frame is the same with the joint's elastic rotation under
/// `loads`, which acts on the fixed side, before the joint's own rotation: its z is the axis of
/// theta. The loads act with their corrections. Forward kinematics and the Jacobian are the same
/// walk. Linkages with errors put their joints elsewhere than `q` says (PlaceLinkages).
template <typename Visit>
inline void EvaluateMdhFrames(const ErrorModel& model, const Geometry& geometry,
                              const Eigen::VectorXd& q, const JointLoads& loads,
                              std::vector<MdhFrame>& frames, const Visit& visit) {
  const bool loaded = loads.cols() > 0;
  const bool reloaded = !loads.by_correction.empty();
  const JointLoads with_corrections = reloaded ? CorrectedLoads(geometry, loads) : JointLoads();
  const JointLoads& acting = reloaded ? with_corrections : loads;
  const bool corrected = geometry.corrections.size() > 0 && loads.shapes.size() > 0;
  const auto place = [&](int joint, const Geometry::JointConstants& constants,
                         const MdhFrame& parent, bool revolute, double position, MdhFrame& frame) {
    const MdhFrame twisted{parent.R * constants.R_parent_twisted,
                           parent.p + parent.R * constants.p_parent_twisted};
    MdhFrame bent;
    const MdhFrame* deflected = &twisted;
    if (loaded && joint != kWaist && !constants.compliance.isZero(0.0)) {
      bent = Deflected(constants, revolute, acting.col(joint), twisted);
      deflected = &bent;
    }
    visit(joint, constants, parent, twisted, *deflected);
    const double theta = constants.theta + (revolute ? position : 0.0);
    const double r = constants.r + (revolute ? 0.0 : position);
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    frame.R.col(0) = c * deflected->R.col(0) + s * deflected->R.col(1);
    frame.R.col(1) = c * deflected->R.col(1) - s * deflected->R.col(0);
    frame.R.col(2) = deflected->R.col(2);
    frame.p = deflected->p + r * deflected->R.col(2);
  };
  const MdhFrame reference{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  place(kWaist, geometry.waist, reference, true, 0.0, frames[0]);
  frames[0].R = frames[0].R * geometry.T_joint_waist.linear();
  if (corrected) {
    const Vector6d step = RootCorrection(model, geometry, loads);
    frames[0].p += frames[0].R * step.head<3>();
    frames[0].R = frames[0].R * RotationFromVector(step.tail<3>());
  }
  const bool linked = !model.tree.linkages.empty();
  const Eigen::VectorXd closed =
      linked ? PlaceLinkages(model.tree, geometry.linkage_errors, q).q : Eigen::VectorXd();
  for (int k : model.active_joints) {
    const Joint& joint = model.tree.joints[k];
    const Geometry::JointConstants& constants = geometry.joints[k];
    MdhFrame bent_root;
    const MdhFrame* parent = &frames[joint.parent_body];
    if (loads.about_root.cols() > 0 && !constants.root_compliance.isZero(0.0)) {
      bent_root = BentRoot(constants, loads.about_root.col(k), *parent);
      parent = &bent_root;
    }
    place(k, constants, *parent, joint.type == JointType::kRevolute,
          JointPosition(joint, linked ? closed : q) +
              (corrected ? PositionCorrection(model, geometry, loads, k) : 0.0),
          frames[k + 1]);
  }
}

}  // namespace elastocal
