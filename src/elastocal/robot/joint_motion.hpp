#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Joint positions that a robot shall go through: a trajectory or a list of postures. What is
/// planned, and what is played, pass it on.
struct JointMotion {
  std::string source;  ///< the file, for messages
  /// Of each sample, strictly increasing; empty: postures one after the other, and whoever plays
  /// them decides when.
  Eigen::VectorXd time_s;
  /// samples x coordinates of the robot tree, rad or m. A column of NaN: nothing is said of that
  /// joint.
  Eigen::MatrixXd q;
  /// By sample, the links that stand on the floor, of the tree; none of them: the root link is
  /// held. Empty: nothing is said of it.
  std::vector<std::vector<int>> support = {};
  std::vector<int> line = {};  ///< of each sample in the file; empty where there is no file

  int sample_count() const { return static_cast<int>(q.rows()); }
};

}  // namespace elastocal
