// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/torque_limit.hpp"

#include <cmath>

namespace elastocal {

TorqueLimit::TorqueLimit(const RobotTree& tree, const std::vector<int>& coordinates, double share) {
  for (int coordinate : coordinates) {
    const Joint& joint = tree.joints[tree.coordinate_joint[coordinate]];
    if (!std::isfinite(joint.limits.effort) || joint.limits.effort <= 0.0) continue;
    coordinates_.push_back(coordinate);
    effort_.push_back(joint.limits.effort);
    joints_.push_back(joint.name);
  }
  const auto count = static_cast<Eigen::Index>(coordinates_.size());
  SetRange(Eigen::VectorXd::Constant(count, -share), Eigen::VectorXd::Constant(count, share));
}

std::string TorqueLimit::Name(int row) const { return "torque of " + joints_[row]; }

void TorqueLimit::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                           Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  for (int row = 0; row < size(); ++row) {
    value[row] = chain.GravityTorque(coordinates_[row]) / effort_[row];
    jacobian.row(row) = chain.GravityTorqueGradient(coordinates_[row]) / effort_[row];
  }
}

}  // namespace elastocal
