// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Nominal positions of markers in a frame that does not move in the laboratory: that of the link
/// that stands still or, of three and more such links, the one in which their origins do, as far
/// as nominal kinematics allows. (Feet that are balls roll, and what is above them turns about
/// their centres.)
class StandingKinematics {
 public:
  /// `markers`: of the robot; `standing`: links.
  StandingKinematics(const MarkedRobot& robot, const std::vector<int>& markers,
                     const std::vector<int>& standing);

  /// By the tree's coordinates `q`, rad or m: 3 x markers, m.
  Eigen::Matrix3Xd Positions(const Eigen::VectorXd& q) const;

  /// Poses of the root and of the bodies that move a marker or a standing link (others: of no use).
  std::vector<Transform> Bodies(const Eigen::VectorXd& q) const;

  /// Where the markers are if the bodies are there.
  Eigen::Matrix3Xd PositionsOn(const std::vector<Transform>& bodies) const;

 private:
  /// Of the standing links, in the root link's frame.
  Eigen::Matrix3Xd Origins(const std::vector<Transform>& T_root_body) const;

  std::vector<Link> standing_;
  Eigen::Matrix3Xd origins_;  ///< in the frame in which they stand still; empty: one link does
  std::vector<int> bodies_;
  std::vector<Eigen::Vector3d> p_body_marker_;
  ErrorModel model_;
  Geometry geometry_;
};

}  // namespace elastocal
