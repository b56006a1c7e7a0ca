// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Share of a joint's range that postures leave free at either end, unless the project says
/// otherwise.
inline constexpr double kUsualLimitMargin = 0.02;

/// A box in the root link's frame, m.
struct Box {
  Eigen::Vector3d lower, upper;
};

/// Where a chain may move while the rest of the robot rests (paper section 3.1).
struct ChainSetup {
  std::string name;  ///< of the chain
  int from_link = 0, tip_link = 0;
  std::vector<int> coordinates;  ///< coordinates that move the chain, from the root outwards
  std::string mirror;        ///< the chain on the other side that gets mirrored postures, or empty
  std::vector<int> support;  ///< feet that stand on the floor (links)
  std::optional<Box> box;    ///< where the tip link's origin must be, eq. 10
  double largest_turn = M_PI;        ///< largest rotation of the tip from the posture of rest, rad
  std::vector<SpherePair> contacts;  ///< spheres that can touch, eq. 11
  /// How far the tip stays from singular postures: the least singular value of its Jacobian is at
  /// least this share of the value in the posture of rest. 0: no limit.
  double dexterity_share = 0.0;
  /// Height of the floor in the root link's frame, m. The chain's own spheres stay above it.
  std::optional<double> floor_z;
};

/// What all chains share: the posture of rest, limits and collision spheres.
struct MotionSetup {
  Eigen::VectorXd rest;          ///< posture of rest, by coordinate of q; within the limits
  Eigen::VectorXd lower, upper;  ///< limits with a margin, by coordinate, rad or m
  Eigen::VectorXd
      room;  ///< left free at a revolute joint's limits for corrections, by coordinate, rad
  double effort_share = 1.0;  ///< share of the URDF's largest torques that may be used, eq. 9
  double motion_effort_share = 0.9;  ///< the same for planned motions, whose joints accelerate
  double sphere_margin = 0.0;        ///< least distance between spheres, m
  std::vector<CollisionSphere> spheres;
  std::vector<ChainSetup> chains;        ///< in the order in which they are calibrated
  std::vector<Eigen::Vector3d> cameras;  ///< in the root link's frame, m; empty: nothing is hidden
  bool free_root = false;  ///< the root link has an unknown pose of its own in each posture
};

}  // namespace elastocal
