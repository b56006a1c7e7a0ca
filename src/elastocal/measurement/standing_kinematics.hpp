// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Nominal positions of markers in a frame that does not move in the laboratory. If one or two
/// links stand still, it is the frame of the first. If the origins of the standing links tell a
/// pose (three or more), it is the frame in which these origins move least, because feet that are
/// balls roll and only their centres stand still.
class StandingKinematics {
 public:
  /// `markers` are indices into the robot's markers; `standing` are the links that stand still.
  StandingKinematics(const MarkedRobot& robot, const std::vector<int>& markers,
                     const std::vector<int>& standing);

  /// Positions of the markers, 3 x markers, m, for the tree's coordinates `q`, rad or m.
  Eigen::Matrix3Xd Positions(const Eigen::VectorXd& q) const;

  /// Poses of all bodies of the tree. Only those of the root and of bodies that move a marker or a
  /// standing link are meaningful.
  std::vector<Transform> Bodies(const Eigen::VectorXd& q) const;

  /// Positions of the markers, 3 x markers, m, for these poses of the bodies.
  Eigen::Matrix3Xd PositionsOn(const std::vector<Transform>& bodies) const;

 private:
  /// Origins of the standing links in the root link's frame, 3 x links, m.
  Eigen::Matrix3Xd Origins(const std::vector<Transform>& T_root_body) const;

  std::vector<Link> standing_;
  /// Origins of the standing links in the frame in which they stand still, m; empty if the frame is
  /// that of the first standing link.
  Eigen::Matrix3Xd origins_;
  std::vector<int> bodies_;
  std::vector<Eigen::Vector3d> p_body_marker_;
  ErrorModel model_;
  Geometry geometry_;
};

}  // namespace elastocal
