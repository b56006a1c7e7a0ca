#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {

/// Coordinates that move `tip_link` against `from_link`, from there outwards; those of joints that
/// follow others stand for both, once.
std::vector<int> ChainCoordinates(const RobotTree& tree, int from_link, int tip_link);

/// A component of what gravity does to a joint: of the moment, about a point and along a direction,
/// of all that the joint carries (N.m), or along a prismatic joint of the force (N). Point and
/// direction are fixed to the body that carries the joint.
struct LoadComponent {
  int joint = -1;  ///< -1: the moment of the whole robot
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::Zero();
};

/// A nominal robot of which some coordinates x move while all others rest: poses, gravity torques
/// and their derivatives by x. Everything is in the root link's frame. Holds the last posture.
class MovingChain {
 public:
  /// `coordinates`: entries of q that x stands for; `rest`: the whole q at rest. Keeps a reference.
  MovingChain(const RobotTree& tree, std::vector<int> coordinates, Eigen::VectorXd rest);

  const RobotTree& tree() const { return tree_; }
  const std::vector<int>& coordinates() const { return coordinates_; }
  int size() const { return static_cast<int>(coordinates_.size()); }

  /// Goes to posture x, rad or m, of size().
  void Move(const Eigen::VectorXd& x);
  Eigen::VectorXd FullPosture(const Eigen::VectorXd& x) const;  ///< the whole q

  /// Of the posture moved to, as all below.
  const std::vector<Transform>& link_poses() const { return T_root_link_; }
  /// Derivatives of a point of a link, given where it is now, 3 x size().
  Eigen::Matrix3Xd PointJacobian(int link, const Eigen::Vector3d& p_root_point) const;
  /// Rotation vectors of a link's turning, 3 x size().
  Eigen::Matrix3Xd RotationJacobian(int link) const;

  /// Torque that the motor of a coordinate of q supplies to balance gravity while the root link is
  /// held, N.m or N, and its derivatives by x (eq. 9).
  double GravityTorque(int coordinate) const;
  Eigen::RowVectorXd GravityTorqueGradient(int coordinate) const;

  /// Derivatives by x of a sum of components of loads, `gravity` in m/s^2.
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
