// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

struct PlacementOptions {
  /// Consecutive axes whose angle is smaller than this need `beta` (Hayati), rad. Well above the
  /// errors of a robot: the common normal of nearly parallel axes is far away, and small errors
  /// move it by much.
  double parallel_tolerance_rad = 10.0 * M_PI / 180.0;
  /// Axes that are inclined to each other by less than 45 degrees also need `beta`, if an error of
  /// their directions moves their common normal along them by more than this, m/rad. (This lever is
  /// the distance of the normal from the second joint over the sine of the angle.) The shoulders of
  /// some humanoids are inclined by 10 to 20 degrees; their normals are a metre away.
  double longest_lever_m = 1.0;
};

/// Nominal placement of a joint in the modified Denavit-Hartenberg convention with beta and, if
/// `general`, with the two additional constants of Khalil and Kleinfinger (paper eq. 1):
///
///   T_parent_joint = T_parent_pre Rotz(gamma) Trz(b)
///                    Roty(beta) Rotx(alpha) Trx(d) Rotz(theta + position) Trz(r)
///
/// `parent` and `joint` are MDH frames: z along the joint's axis, x along the common normal with
/// the axis of the joint that continues the chain (for the body of the root: the root link's
/// frame). They are not the URDF's link frames; `T_joint_body` leads from one to the other, so that
/// nominal kinematics equal the URDF's.
///
/// Eq. 1 alone has no displacement along y, so it cannot place the first joint after the waist or
/// after a branch. It cannot place a joint whose axis coincides with the one before it (within 2
/// cm), because d covers only one of the two directions in which the axes can part. It cannot place
/// a joint whose axis is parallel to that of a prismatic joint before it (arm and head of a robot
/// with a lift): the place of a sliding axis has no meaning, so that the turn about it, which works
/// between parallel axes of rotation, would turn all that slides for a shift of one axis. Such a
/// joint is `general`: T_parent_pre is a constant frame on its axis with z at right angles to it,
/// nominal alpha is 90 degrees and the other constants are zero. The six displacements are then
/// along and about three orthogonal axes and never singular.
struct JointPlacement {
  bool general = false;
  bool parallel = false;  ///< the axis is (nearly) parallel to the one before it: beta is in use
  Transform T_parent_pre = Transform::Identity();
  double gamma = 0.0, b = 0.0, beta = 0.0, alpha = 0.0, d = 0.0, theta = 0.0, r = 0.0;
  Transform T_joint_body = Transform::Identity();
};

/// Placement of every joint of the tree, in its order. At a branch the first joint in the file
/// continues the chain and the others are general. This is decided on the whole tree, so that a
/// parameter means the same whichever markers are recorded.
std::vector<JointPlacement> PlaceJoints(const RobotTree& tree, const PlacementOptions& options);

}  // namespace elastocal
