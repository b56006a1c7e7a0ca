// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/posture/constraint.hpp"

namespace elastocal {

/// Where the end of a chain may be (paper section 3.1 and Fig. 2a), in the root link's frame.
struct Workspace {
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(-1e3);  ///< of the end link's origin, m
  Eigen::Vector3d upper = Eigen::Vector3d::Constant(1e3);
  Eigen::Matrix3d R_root_end = Eigen::Matrix3d::Identity();  ///< nominal orientation
  double largest_turn = M_PI;                                ///< largest angle from it, rad
};

/// Eq. 10, position: the origin of `link` stays in a box.
class EndBox : public PostureConstraint {
 public:
  EndBox(int link, const Workspace& workspace);
  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  int link_;
};

/// Eq. 10, orientation: limits the angle by which `link` is turned from nominal. The value is its
/// cosine, which is smooth everywhere.
class OrientationCone : public PostureConstraint {
 public:
  OrientationCone(int link, const Workspace& workspace);
  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  int link_;
  Eigen::Matrix3d R_root_end_;
};

}  // namespace elastocal
