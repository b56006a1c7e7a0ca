// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {

/// Coordinates that move `tip_link` against `from_link`, from there outwards. A coordinate that
/// drives several joints occurs once.
std::vector<int> ChainCoordinates(const RobotTree& tree, int from_link, int tip_link);

/// A component of the load of gravity on a joint: the moment of everything that the joint carries,
/// about a point and along a direction (N.m), or the force along a prismatic joint (N). Point and
/// direction are fixed to the body that carries the joint.
struct LoadComponent {
  int joint = -1;  ///< -1: the moment of the whole robot
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::Zero();
};

/// A nominal robot of which some coordinates x move while all others rest. It gives poses, gravity
/// torques and their derivatives by x, all in the root link's frame and for the last posture.
class MovingChain {
 public:
  /// `coordinates` are the entries of q that make up x; `rest` is the whole q in the posture of
  /// rest. Keeps a reference to the tree.
  MovingChain(const RobotTree& tree, std::vector<int> coordinates, Eigen::VectorXd rest);

  const RobotTree& tree() const { return tree_; }
  const std::vector<int>& coordinates() const { return coordinates_; }
  int size() const { return static_cast<int>(coordinates_.size()); }

  /// Moves to posture x, of size(), rad or m.
  void Move(const Eigen::VectorXd& x);
  Eigen::VectorXd FullPosture(const Eigen::VectorXd& x) const;  ///< the whole q

  /// Poses of the links. Like everything below, they are those of the posture moved to.
  const std::vector<Transform>& link_poses() const { return T_root_link_; }
  /// Derivatives by x of a point of a link, 3 x size(); the point is given by its present position.
  Eigen::Matrix3Xd PointJacobian(int link, const Eigen::Vector3d& p_root_point) const;
  /// Derivatives by x of a link's rotation, as rotation vectors, 3 x size().
  Eigen::Matrix3Xd RotationJacobian(int link) const;

  /// Derivatives by x of u^T J v, where J is the displacement of a link's origin by x above its
  /// rotation, for constant u (6) and v (size()).
  Eigen::RowVectorXd JacobianGradient(int link, const Eigen::VectorXd& u,
                                      const Eigen::VectorXd& v) const;

  /// Torque that the motor of a coordinate of q supplies to balance gravity while the root link is
  /// held, N.m or N, and its derivatives by x (eq. 9).
  double GravityTorque(int coordinate) const;
  Eigen::RowVectorXd GravityTorqueGradient(int coordinate) const;

  /// Derivatives by x of a sum of load components; `gravity` in m/s^2.
  Eigen::VectorXd LoadGradient(const std::vector<LoadComponent>& components,
                               const Eigen::Vector3d& gravity) const;

 private:
  struct Driven {
    int joint, variable;  // variable: entry of x
    double multiplier;
  };
  Eigen::Vector3d Axis(int joint) const;
  Eigen::Vector3d Origin(int joint) const;
  Eigen::Vector3d MomentGradient(int joint) const;
  double PotentialCurvature(int inner, int outer) const;

  const RobotTree& tree_;
  std::vector<int> coordinates_;
  Eigen::VectorXd q_;
  std::vector<std::vector<Driven>> driven_;  // by body: joints before it that x drives
  std::vector<Driven> all_driven_;
  std::vector<std::vector<char>> carries_;  // by joint: whether it carries another, or is it
  std::vector<Transform> T_root_link_;
  std::vector<CarriedLoad> carried_;
};

}  // namespace elastocal
