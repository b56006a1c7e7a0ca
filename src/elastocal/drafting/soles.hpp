// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/drafting/limbs.hpp"

namespace elastocal {

/// The underside of a leg's foot, as it is drafted.
struct DraftedSole {
  int limb = 0;
  std::string link;     ///< whose frame lies in the floor, z up
  bool added = false;   ///< the URDF has no such link: it is added
  int parent_link = 0;  ///< of an added link
  Transform T_parent_sole = Transform::Identity();
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corner of least x and y, m
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();
  /// m; only of a foot that is a ball, because its leg has too few joints to lay a sole flat. Its
  /// corners are 0.
  std::optional<double> ball_radius = {};
  bool guessed_size = false;    ///< no shape says how large the sole is
  bool guessed_height = false;  ///< nor a link where it is
};

/// Finds the soles of the legs. The floor is under the lowest points of a foot's shapes in the zero
/// posture, in which soles lie flat, and what of the shapes is next to it touches it. Without
/// shapes, a link fixed to the last body whose z axis points up is the sole, and otherwise the foot
/// is taken to be as high as usual. Corners are in the sole's frame. The foot of a leg of three or
/// four joints of its own is a ball about its tip, which reaches down to the lowest point of its
/// shapes in the zero posture.
std::vector<DraftedSole> FindSoles(const RobotTree& tree, const RobotShapes& shapes,
                                   const Limbs& limbs);

/// Distance between the centres of two soles, m, at which feet do not touch where errors of the
/// robot bring them nearer: given if they are closer in the zero posture.
std::optional<double> ChooseStance(const RobotTree& tree, const Limbs& limbs,
                                   const std::vector<DraftedSole>& soles);

/// The URDF with the links that soles add, fixed to the feet and without mass.
std::string AddSoleLinks(const std::string& urdf, const RobotTree& tree,
                         const std::vector<DraftedSole>& soles);

}  // namespace elastocal
