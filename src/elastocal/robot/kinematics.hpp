// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"

namespace elastocal {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The loads of the joints, 3 x joints of the tree: the moment of the load about the joint's
/// physical centre (the URDF's joint origin), in the axes of its twisted frame (mdh_frames.hpp),
/// N.m. For a prismatic joint only z counts: the force along its axis, N. Empty means no load. The
/// load deflects the joint, so m_z is the opposite of the torque that the motor supplies. See
/// statics.hpp.
struct JointLoads : Eigen::Matrix3Xd {
  using Eigen::Matrix3Xd::Matrix;
  using Eigen::Matrix3Xd::operator=;

  /// For joints on the root link: moment of the load about the root link's origin, in its axes, 3 x
  /// joints of the tree, N.m. A root link that bends turns the joint by it. Empty: none.
  Eigen::Matrix3Xd about_root;
  /// Values of the functions that the model's corrections multiply in this posture
  /// (EvaluateShapes); empty: no correction acts.
  Eigen::VectorXd shapes;
  /// For each correction of the model that acts on loads, the derivative of the loads by it
  /// (statics.hpp), 3 x joints of the tree; for other corrections a matrix of no size. The loads
  /// themselves are without these corrections. Empty: there are none.
  std::vector<Eigen::Matrix3Xd> by_correction;
};

/// The error model with a vector of errors applied: everything in eq. 1-3 that does not depend on
/// the posture. It is cheap to make (a few trigonometric functions for each joint), and can be used
/// for many postures.
struct Geometry {
  /// The constants of a joint between its parent's MDH frame (the root link's frame for joints on
  /// the waist) and its own. Directions and points are in the parent frame.
  struct JointConstants {
    Eigen::Matrix3d
        R_parent_twisted;  ///< T_parent_pre Rotz(gamma) Trz(b) Roty(beta) Rotx(alpha) Trx(d)
    Eigen::Vector3d p_parent_twisted;
    Eigen::Vector3d z_pre, p_pre;    ///< axis of gamma and b
    Eigen::Vector3d y_beta, p_beta;  ///< axis of beta
    double theta, r;                 ///< constants of eq. 1, without the joint's position
    double centre;                   ///< z of the physical centre in the twisted frame, m
    /// Compliance about x, y, z of the twisted frame, rad/(N.m); of a prismatic joint, along z
    /// only, m/N.
    Eigen::Vector3d compliance;
    /// For a joint on the root link: compliance of the root link up to this joint, about the root
    /// link's origin and axes, rad/(N.m).
    Eigen::Vector3d root_compliance = Eigen::Vector3d::Zero();
  };
  std::vector<JointConstants>
      joints;               ///< one for each joint of the tree; only active ones are filled
  JointConstants waist;     ///< eq. 2, as if the waist were a joint at position 0
  Transform T_joint_waist;  ///< constant that ends eq. 2, see ApplyErrors
  /// For each leg, in the axes of its foot: along x, y, z in m/N, then about x, y, z in rad/(N.m).
  std::vector<Vector6d> leg_compliance;
  /// For each joint, measured minus true torque, N.m (N). Empty if the model has no legs.
  Eigen::VectorXd torque_bias;
  /// Errors of each linkage of the tree, in the order of its uncertain quantities. Empty: none.
  std::vector<Eigen::VectorXd> linkage_errors;
  /// Value of each correction of the model's elasticity. Empty if it has none.
  Eigen::VectorXd corrections;
  std::vector<Eigen::Vector3d> p_joint_marker;  ///< by marker, in its body's MDH frame
  std::vector<Eigen::Matrix3d> R_joint_link;    ///< by marker: axes of its x, y, z
};

/// Number of parameters of eq. 2. They are the first ones of a model.
inline constexpr int kWaistParameterCount = 6;

/// Applies the errors `delta` (one for each parameter of the model, SI).
///
/// The pose of the waist (eq. 2) is T_ref_waist Rotz(gamma) Trz(b) Rotx(pi/2 + alpha) Trx(d)
/// Rotz(theta) Trz(r) Rotx(-pi/2). The intermediate frame makes nominal alpha 90 degrees, where eq.
/// 2 is regular.
Geometry ApplyErrors(const ErrorModel& model, const Eigen::VectorXd& delta);

/// Replaces only the waist's pose, by `T_ref_waist` displaced by the six errors of eq. 2.
/// ApplyErrors does the same with the model's own T_ref_waist. It is cheap enough for a waist that
/// has another pose in each posture.
void PlaceWaist(const Transform& T_ref_waist, const Vector6d& t0_errors, Geometry& geometry);

/// Pose of the root link in the reference frame (eq. 2).
Transform WaistPose(const Geometry& geometry);

/// Forward kinematics (eq. 3): positions of all markers in the reference frame for one posture of
/// the tree, 3 x N_M, m, with the joints deflected by `loads`.
Eigen::Matrix3Xd MarkerPositions(const ErrorModel& model, const Geometry& geometry,
                                 const Eigen::VectorXd& q, const JointLoads& loads = {});

/// Position of a marker in the frame of a link of its own body, m, and the axes of the marker's
/// coordinates in that frame (columns). Both are the same in all postures, because corrections of
/// the marker are left out.
struct MarkerInLink {
  Eigen::Vector3d position;
  Eigen::Matrix3d axes;
};
MarkerInLink PlaceMarker(const ErrorModel& model, const Geometry& geometry, int marker, int link);

/// The loads that deflect the joints: `loads` plus the corrections of loads in `geometry`.
JointLoads CorrectedLoads(const Geometry& geometry, const JointLoads& loads);

/// Position of a marker in its body's MDH frame, with its corrections, m.
Eigen::Vector3d MarkerInBody(const ErrorModel& model, const Geometry& geometry,
                             const JointLoads& loads, int marker);

/// Poses of the bodies in the reference frame: that of the root, then those of the bodies that
/// active joints move (others are identity). Body frames are those of RobotTree.
std::vector<Transform> BodyTransforms(const ErrorModel& model, const Geometry& geometry,
                                      const Eigen::VectorXd& q, const JointLoads& loads = {});

/// Poses of all links in the reference frame. Links that no active joint moves are placed by the
/// nominal URDF, with their joints at `q`.
std::vector<Transform> CalibratedLinkTransforms(const ErrorModel& model, const Geometry& geometry,
                                                const Eigen::VectorXd& q,
                                                const JointLoads& loads = {});

}  // namespace elastocal
