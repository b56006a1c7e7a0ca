// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"
#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Covers points by spheres: by as few as keep their radii close to the thickness of the whole, at
/// most `most`. No point is further than `tolerance` [m] outside a sphere.
std::vector<CollisionSphere> CoverPoints(const std::vector<Eigen::Vector3d>& points,
                                         double tolerance, int most);

/// The radius from which CoverPoints needs no more spheres: about half of the thickness of a rod,
/// or of the shorter side of a plate.
double FittingRadius(const std::vector<Eigen::Vector3d>& points, double tolerance);

/// Spheres that cover all bodies of the robot, in the frames of the bodies' links, rounded to mm,
/// with unique names. Parts that are symmetric to the root link's x-z plane in the zero posture get
/// symmetric spheres. Fingers are covered together with the hand, in the posture of rest. A body
/// with several shapes is covered shape by shape if one cover of all would be much thicker than
/// they are.
std::vector<CollisionSphere> CoverRobot(const RobotTree& tree, const RobotShapes& shapes,
                                        const Limbs& limbs, const Eigen::VectorXd& rest);

/// A sentence for each body whose spheres are more than twice as thick as its shapes require.
std::vector<std::string> CoarseCovers(const RobotTree& tree, const RobotShapes& shapes,
                                      const std::vector<CollisionSphere>& spheres);

/// Pairs of spheres whose distance changes with the joints `coordinates`. Left out are pairs that
/// touch by design (on neighbouring bodies, or on two sections of a telescope: prismatic joints
/// with parallel axes between them) and pairs that the SRDF excludes from checks.
std::vector<SpherePair> PairsMovedBy(const RobotTree& tree,
                                     const std::vector<CollisionSphere>& spheres,
                                     const std::vector<int>& coordinates,
                                     const Semantics& semantics);

/// Result of FindContacts.
struct ContactSearch {
  std::vector<SpherePair> pairs;             ///< pairs that can touch, the most frequent first
  std::vector<SpherePair> touching_at_rest;  ///< pairs that touch in a posture of rest; left out
};

/// Selects from `candidates` the pairs that can touch while the chain moves over its ranges, or
/// over its box enlarged by a quarter, with everything else in the first posture of `rests`. They
/// are found in 1500 random postures. Pairs that touch in one of `rests` or nearly always, and
/// pairs that never touch, are left out.
ContactSearch FindContacts(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
                           const std::vector<SpherePair>& candidates,
                           const std::vector<Eigen::VectorXd>& rests, const ChainSetup& chain,
                           double margin);

}  // namespace elastocal
