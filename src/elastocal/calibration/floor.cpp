// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/floor.hpp"

#include <cmath>

#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

FloorResidual EvaluateFloor(const Transform& T_ref_foot, const Transform& T_ref_first,
                            const Eigen::Vector3d& up, const Eigen::Vector3d& up_foot) {
  const Eigen::Vector3d a = up.unitOrthogonal();
  Eigen::Matrix3d axes;
  axes << a.transpose(), up.cross(a).transpose(), up.transpose();
  const Eigen::Matrix3d R = axes * T_ref_foot.linear();
  FloorResidual result;
  result.residual = R * up_foot;
  result.residual[2] = up.dot(T_ref_foot.translation() - T_ref_first.translation());
  result.by_foot << Eigen::Matrix3d::Zero(), -R * Skew(up_foot);
  result.by_foot.row(2) << R.row(2), Eigen::RowVector3d::Zero();
  result.height_by_first << -up.transpose() * T_ref_first.linear(), Eigen::RowVector3d::Zero();
  return result;
}

FloorUse UseOfFloor(const FloorResidual& placed) {
  constexpr double kMostTilt = 8.0 * M_PI / 180.0, kMostHeight = 0.020;
  return {placed.residual.head<2>().norm() <= kMostTilt,
          std::abs(placed.residual[2]) <= kMostHeight};
}

std::vector<int> FloorFootings(const Placement& placement) {
  std::vector<int> footings;
  for (std::size_t f = 0; f < placement.footings.size(); ++f) {
    if (placement.footings[f].leg >= 0) footings.push_back(static_cast<int>(f));
  }
  return footings;
}

Eigen::Vector3d UpOfFoot(const ErrorModel& model, int leg) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.tree.coordinate_count());
  const auto link = static_cast<std::size_t>(model.legs[static_cast<std::size_t>(leg)].link);
  return LinkTransforms(model.tree, zero)[link].linear().row(2).transpose();
}

}  // namespace elastocal
