// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"
#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Spheres around points: as few as keep their radii near the thickness of the whole, at most
/// `most`. No point is further than `tolerance` [m] outside a sphere.
std::vector<CollisionSphere> CoverPoints(const std::vector<Eigen::Vector3d>& points,
                                         double tolerance, int most);

/// The radius from which on CoverPoints needs no more spheres: about half of the thickness of a
/// rod, or of the shorter side of a plate.
double FittingRadius(const std::vector<Eigen::Vector3d>& points, double tolerance);

/// Spheres that cover all bodies of the robot, in the frames of the bodies' links, rounded to mm.
/// Names are unique. What is symmetric to the root link's x-z plane in the zero posture gets
/// spheres that are. Fingers, as they are at rest, are
/// covered together with the hand. A body of several shapes is covered shape by shape where one
/// cover of all would be much thicker than they are.
std::vector<CollisionSphere> CoverRobot(const RobotTree& tree, const RobotShapes& shapes,
                                        const Limbs& limbs, const Eigen::VectorXd& rest);

/// A sentence for each body whose spheres are more than twice as thick as would fit its shapes.
std::vector<std::string> CoarseCovers(const RobotTree& tree, const RobotShapes& shapes,
                                      const std::vector<CollisionSphere>& spheres);

/// Pairs of spheres whose distance changes with the joints `coordinates` and that do not lie
/// against each other by design: not on neighbouring bodies nor on two sections of a telescope
/// (prismatic joints with parallel axes between them), and not listed by the SRDF as never checked.
std::vector<SpherePair> PairsMovedBy(const RobotTree& tree,
                                     const std::vector<CollisionSphere>& spheres,
                                     const std::vector<int>& coordinates,
                                     const Semantics& semantics);

struct ContactSearch {
  std::vector<SpherePair> pairs;             ///< that can touch, the most frequent first
  std::vector<SpherePair> touching_at_rest;  ///< in a posture of rest; left out
};

/// Of `candidates`, the pairs that can touch while the chain moves over its ranges, or over its box
/// made wider by a quarter, and all else is in the first posture of `rests`: found in 1500 random
/// postures. Left out are those that touch in one of `rests` or nearly always, and those that never
/// do.
ContactSearch FindContacts(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
                           const std::vector<SpherePair>& candidates,
                           const std::vector<Eigen::VectorXd>& rests, const ChainSetup& chain,
                           double margin);

}  // namespace elastocal
