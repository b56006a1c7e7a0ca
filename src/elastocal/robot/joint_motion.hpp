// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Joint positions that a robot is to go through: a trajectory or a list of postures. The planner
/// makes it, and the simulator plays it.
struct JointMotion {
  std::string source;  ///< the file, for messages
  /// Time of each sample, strictly increasing. Empty for a list of postures: whoever plays them
  /// decides when.
  Eigen::VectorXd time_s;
  /// samples x coordinates of the robot tree, rad or m. A column of NaN leaves that joint open.
  Eigen::MatrixXd q;
  /// For each sample, the links of the tree that stand on the floor; if there are none, the root
  /// link is held still. Empty if the support is left open.
  std::vector<std::vector<int>> support = {};
  std::vector<int> line = {};  ///< of the file, for each sample; empty if there is no file

  int sample_count() const { return static_cast<int>(q.rows()); }
};

}  // namespace elastocal
