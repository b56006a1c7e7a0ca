#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A leg: the joints from the root link to a sole. They must be six, and none may be a mimic joint
/// or drive one.
class LegChain {
 public:
  /// Keeps a reference. Throws InputError for another number of joints, and for mimic joints.
  LegChain(const RobotTree& tree, int sole_link);

  int sole_link() const { return sole_link_; }
  const std::vector<int>& coordinates() const { return coordinates_; }  ///< of q, from the root on

  /// Pose of the sole in the root link's frame.
  Transform SolePose(const Eigen::VectorXd& q) const;

  /// Moves the leg's joints in `q` by Newton's method until the sole has the given pose in the root
  /// link's frame (1e-11 m and rad). Limits are not checked. Returns false, with the joints
  /// anywhere, if the pose is out of reach or the knee gets straight.
  bool Place(const Transform& T_root_sole, Eigen::VectorXd& q) const;

 private:
  Transform Evaluate(const Eigen::VectorXd& q, Eigen::Matrix<double, 6, 6>& screws) const;

  const RobotTree& tree_;
  int sole_link_;
  std::vector<int> joints_, coordinates_;
};

}  // namespace elastocal
