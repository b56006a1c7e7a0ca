// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/drafting/mesh.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// What a body looks like from outside.
struct BodyShape {
  int link = 0;                         ///< whose frame is the body's frame
  std::vector<Eigen::Vector3d> points;  ///< of the surface, in the body's frame, m; may be none
  /// Whether the URDF has no shape that could be read, and the points are those of rods between the
  /// joints, as thick as the body's mass makes them.
  bool guessed = false;
  /// The same points, shape by shape, where shapes were read.
  std::vector<std::vector<Eigen::Vector3d>> parts = {};
};

struct RobotShapes {
  std::vector<BodyShape> bodies;  ///< one a body of the tree
  int meshes = 0;                 ///< that were read
  std::vector<std::string> warnings;
};

/// Reads the boxes, cylinders, spheres and meshes of a URDF: those for collisions or, on a link
/// without any that can be read, those to look at. A shape that would be lighter than 20 kg/m^3
/// with the mass of its link, or a mesh larger than the robot, is no shape of this link and is left
/// out with a warning; so is a mesh that is missing or cannot be read. `text` is the URDF that
/// `tree` was read from, `source` names it in messages. Throws InputError for sizes that are no
/// numbers within bounds.
RobotShapes ReadBodyShapes(const RobotTree& tree, const std::string& text,
                           const std::string& source, const MeshPlaces& places);

/// Length of the longest branch: the sum of the distances between joints from the root to the end
/// of a body, m. Lengths that a draft has to choose are shares of it.
double LongestBranch(const RobotTree& tree);

/// Poses of all bodies in the root link's frame.
std::vector<Transform> BodyPoses(const RobotTree& tree, const Eigen::VectorXd& q);

/// The link whose frame is the body's: the root link, or the one that the body's joint moves.
int BodyLink(const RobotTree& tree, int body);

}  // namespace elastocal
