// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/workspace.hpp"

#include <cmath>

namespace elastocal {

EndBox::EndBox(int link, const Workspace& workspace) : link_(link) {
  SetRange(workspace.lower, workspace.upper);
}

std::string EndBox::Name(int row) const { return std::string("workspace along ") + "xyz"[row]; }

void EndBox::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                      Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  value = chain.link_poses()[link_].translation();
  jacobian = chain.PointJacobian(link_, value);
}

OrientationCone::OrientationCone(int link, const Workspace& workspace)
    : link_(link), R_root_end_(workspace.R_root_end) {
  SetRange(Eigen::VectorXd::Constant(1, std::cos(workspace.largest_turn)),
           Eigen::VectorXd::Constant(1, 2.0));
}

std::string OrientationCone::Name(int) const { return "orientation of the end"; }

void OrientationCone::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                               Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  // trace(R0^T R) = 1 + 2 cos(angle); turning R by w changes it by w . sum_i r_i x r0_i, where r_i
  // and r0_i are the columns.
  const Eigen::Matrix3d R = chain.link_poses()[link_].linear();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) gradient += R.col(i).cross(R_root_end_.col(i));
  value[0] = 0.5 * (R_root_end_.cwiseProduct(R).sum() - 1.0);
  jacobian = 0.5 * gradient.transpose() * chain.RotationJacobian(link_);
}

}  // namespace elastocal
