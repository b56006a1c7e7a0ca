// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {

/// One of the feet that a robot stands on: its pose by kinematics from the root link, and its pose
/// on the floor.
struct StandingFoot {
  Transform T_root_foot = Transform::Identity();
  Transform T_floor_foot = Transform::Identity();
  double share = 0.5;  ///< of the weight; those of all feet add up to 1
};

/// The root link of a robot that stands on several feet, and how it moves.
struct RootOnFeet {
  Transform T_floor_root = Transform::Identity();
  /// For each foot, 6 x 6: rotation [rad] and displacement of the root's origin [m], in the axes of
  /// the floor, by a screw [a; m] of the foot in the root's frame (an error of that leg).
  std::vector<Matrix6d> by_foot;
};

/// Places the root link of a robot on several feet. Because of their errors, the legs disagree
/// about the root's pose, and feet that stand firmly force them together. The pose is the mean of
/// those by each leg, weighted by the shares of the feet (rotations by their rotation vectors from
/// the first one). Throws std::invalid_argument without feet.
RootOnFeet PlaceRootOnFeet(const std::vector<StandingFoot>& feet);

/// Closure of the legs: the pose of the root by each further foot relative to that by the first, as
/// displacement of its origin [m] and rotation vector [rad]; 6 x (feet - 1).
Eigen::Matrix<double, 6, Eigen::Dynamic> FootClosure(const std::vector<StandingFoot>& feet);

/// Loads of the joints (as GravityLoads has them) of a robot that stands on several feet. The floor
/// carries the share of each foot of the whole weight at a point under it. These points lie as far
/// from the feet's origins as the centre of mass is from their weighted mean: the same for all
/// feet, so that the moments balance.
///
/// The model's reference frame is that of its root link. `foot_links`: one a foot. The floor is
/// level. `deflected_by`: see GravityLoads.
JointLoads SharedSupportLoads(const ErrorModel& model, const Geometry& geometry,
                              const Eigen::VectorXd& q, const std::vector<int>& foot_links,
                              const std::vector<StandingFoot>& feet,
                              const JointLoads& deflected_by = {});

}  // namespace elastocal
