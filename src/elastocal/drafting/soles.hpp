// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// Drafted sole of a leg's foot.
struct DraftedSole {
  int limb = 0;
  std::string link;     ///< link whose frame lies in the floor, z up
  bool added = false;   ///< the URDF has no such link, so that it is added
  int parent_link = 0;  ///< parent of an added link
  Transform T_parent_sole = Transform::Identity();
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corner of smallest x and y, m
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();
  /// Radius, m, of a foot that is a ball, because its leg has too few joints to lay a sole flat.
  /// Its corners are then 0.
  std::optional<double> ball_radius = {};
  bool guessed_size = false;    ///< no shape tells the size of the sole
  bool guessed_height = false;  ///< and no link tells its place
};

/// Finds the soles of the legs. The floor is below the lowest points of a foot's shapes in the zero
/// posture, in which soles lie flat, and the points of the shapes close to it touch it. Without
/// shapes, the sole is a link that is fixed to the last body with its z axis up; without such a
/// link, the foot has a usual height. Corners are in the sole's frame. The foot of a leg with only
/// three or four own joints is a ball about its tip, which reaches down to the lowest point of its
/// shapes in the zero posture.
std::vector<DraftedSole> FindSoles(const RobotTree& tree, const RobotShapes& shapes,
                                   const Limbs& limbs);

/// Distance between the centres of two soles, m, at which the feet do not touch even if errors of
/// the robot bring them nearer. Given only if they are closer in the zero posture.
std::optional<double> ChooseStance(const RobotTree& tree, const Limbs& limbs,
                                   const std::vector<DraftedSole>& soles);

/// The URDF with the links that the soles add, fixed to the feet and without mass.
std::string AddSoleLinks(const std::string& urdf, const RobotTree& tree,
                         const std::vector<DraftedSole>& soles);

}  // namespace elastocal
