#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A box in the root link's frame, m.
struct Box {
  Eigen::Vector3d lower, upper;
};

/// What a chain may do while the rest of the robot rests (paper section 3.1).
struct ChainSetup {
  std::string name;  ///< of the chain
  int from_link = 0, tip_link = 0;
  std::vector<int> coordinates;  ///< that move it, from the root outwards
  std::string mirror;            ///< chain on the other side that gets mirrored postures; or empty
  std::vector<int> support;      ///< feet on the floor meanwhile (links)
  std::optional<Box> box;        ///< of the tip link's origin, eq. 10
  double largest_turn = M_PI;    ///< of the tip from its attitude at rest, rad
  std::vector<SpherePair> contacts;  ///< spheres that may meet, eq. 11
  /// Height of the floor in the root link's frame, m, that the chain's own spheres stay above.
  std::optional<double> floor_z;
};

/// What is known about moving a robot: the posture of what does not move, and limits.
struct MotionSetup {
  Eigen::VectorXd rest;          ///< by coordinate of q; within the limits
  Eigen::VectorXd lower, upper;  ///< by coordinate: the limits with a margin, rad or m
  double effort_share = 1.0;     ///< of the URDF's largest torques that may be used, eq. 9
  double sphere_margin = 0.0;    ///< least distance between spheres, m
  std::vector<CollisionSphere> spheres;
  std::vector<ChainSetup> chains;        ///< in the order in which they are calibrated
  std::vector<Eigen::Vector3d> cameras;  ///< in the root link's frame, m; empty: nothing is hidden
};

}  // namespace elastocal
