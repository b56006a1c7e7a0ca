// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// Collects the samples of a motion in which limits keep the end of a limb from its place
/// (Compensator::stopped): their number, and the worst of them.
class StoppedJoints {
 public:
  explicit StoppedJoints(const RobotTree& tree) : tree_(tree) {}

  /// Examines a sample after its Command.
  void Look(const Compensator& compensator, double time_s);

  /// A sentence for each kind of limit: the joints at the limit in the worst sample, the deviation
  /// there, and what the user can do.
  std::vector<std::string> Describe(int samples) const;

 private:
  struct Worst {
    int samples = 0;
    double left_m = 0.0, time_s = 0.0;     ///< `left_m` is Compensator::left_m
    double arm_m = 0.0;                    ///< ec_tip::arm of the limb where that is left
    std::vector<std::string> joints = {};  ///< joints with their limits
    bool turns = false;                    ///< one of them turns
  };
  void Look(const Compensator& compensator, double time_s, CompensatorStatus kind, Worst& worst);
  std::string JointAt(const Compensator& compensator, Eigen::Index coordinate) const;

  const RobotTree& tree_;
  Worst limit_, correction_;
};

}  // namespace elastocal
