#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A leg: the joints from the root link to a sole, which must be six of their own (no mimics).
class LegChain {
 public:
  /// Keeps a reference. Throws InputError for another number of joints, or one that follows others.
  LegChain(const RobotTree& tree, int sole_link);

  int sole_link() const { return sole_link_; }
  const std::vector<int>& coordinates() const { return coordinates_; }  ///< of q, from the root on

  /// Pose of the sole in the root link's frame.
  Transform SolePose(const Eigen::VectorXd& q) const;

  /// Moves the leg's joints by Newton's method, from where they are, until the sole has the given
  /// pose in the root link's frame (1e-11 m and rad). Limits are not looked at. False, with the
  /// joints somewhere, where that fails: out of reach, or a straight knee.
  bool Place(const Transform& T_root_sole, Eigen::VectorXd& q) const;

 private:
  Transform Evaluate(const Eigen::VectorXd& q, Eigen::Matrix<double, 6, 6>& screws) const;

  const RobotTree& tree_;
  int sole_link_;
  std::vector<int> joints_, coordinates_;
};

}  // namespace elastocal
