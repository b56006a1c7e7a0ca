// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/posture/constraint.hpp"

namespace elastocal {

/// Eq. 9: the torques that balance gravity while the root link is held still are at most `share` of
/// the largest torque (the URDF's effort) of each coordinate, in either direction.
class TorqueLimit : public PostureConstraint {
 public:
  /// Coordinates without a finite effort are left out.
  TorqueLimit(const RobotTree& tree, const std::vector<int>& coordinates, double share);

  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  std::vector<int> coordinates_;
  std::vector<double> effort_;
  std::vector<std::string> joints_;
};

}  // namespace elastocal
