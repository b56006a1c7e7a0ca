// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/drafting/mesh.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Outer shape of a body.
struct BodyShape {
  int link = 0;  ///< link whose frame is the body's frame
  /// Points of the surface, in the body's frame, m; may be empty.
  std::vector<Eigen::Vector3d> points;
  /// The URDF has no readable shape of the body. The points are then those of rods between the
  /// joints, as thick as the body's mass requires.
  bool guessed = false;
  /// The same points by shape, where shapes were read.
  std::vector<std::vector<Eigen::Vector3d>> parts = {};
};

struct RobotShapes {
  std::vector<BodyShape> bodies;  ///< one entry a body of the tree
  int meshes = 0;                 ///< number of meshes that were read
  std::vector<std::string> warnings;
};

/// Reads the boxes, cylinders, spheres and meshes of a URDF: the collision shapes or, on a link
/// without any readable one, the visual shapes. A shape that is lighter than 20 kg/m^3 with the
/// mass of its link, or a mesh larger than the robot, cannot be a shape of this link and is left
/// out with a warning, and so is a mesh that is missing or cannot be read. `text` is the URDF from
/// which `tree` was read; `source` names it in messages. Throws InputError for sizes that are no
/// numbers within bounds.
RobotShapes ReadBodyShapes(const RobotTree& tree, const std::string& text,
                           const std::string& source, const MeshPlaces& places);

/// Length of the longest branch, m: the sum of the distances between joints from the root to the
/// end of a body. Lengths in a draft are shares of it.
double LongestBranch(const RobotTree& tree);

/// Poses of all bodies in the root link's frame.
std::vector<Transform> BodyPoses(const RobotTree& tree, const Eigen::VectorXd& q);

/// The link whose frame is the body's: the root link, or the link that the body's joint moves.
int BodyLink(const RobotTree& tree, int body);

}  // namespace elastocal
