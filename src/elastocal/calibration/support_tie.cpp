// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/support_tie.hpp"

#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

TieResidual EvaluateTie(const SupportTie& tie) {
  const Eigen::Matrix3d R_foot_ref = tie.T_ref_foot.linear().transpose();
  const Eigen::Matrix3d R_predicted_ref = tie.T_ref_foot_predicted.linear().transpose();
  const Eigen::Vector3d p_waist = tie.T_ref_waist.translation();
  const Eigen::Vector3d seen = R_foot_ref * (p_waist - tie.T_ref_foot.translation());
  const Eigen::Vector3d rigid =
      R_predicted_ref * (p_waist - tie.T_ref_foot_predicted.translation());
  const Eigen::Matrix3d R_turned = R_foot_ref * tie.T_ref_foot_predicted.linear();
  const Eigen::Vector3d lean = tie.deflection.tail<3>();

  TieResidual result;
  result.residual.head<3>() = seen - rigid - tie.deflection.head<3>();
  const Eigen::Vector3d rotation = RotationVector(R_turned * RotationFromVector(-lean));
  result.residual.tail<3>() = rotation;

  const Eigen::Matrix3d J = InverseLeftJacobian(rotation);
  const auto set = [](Matrix6d& by, const Eigen::Matrix3d& position_first,
                      const Eigen::Matrix3d& position_second, const Eigen::Matrix3d& rotation_first,
                      const Eigen::Matrix3d& rotation_second) {
    by.topLeftCorner<3, 3>() = position_first;
    by.topRightCorner<3, 3>() = position_second;
    by.bottomLeftCorner<3, 3>() = rotation_first;
    by.bottomRightCorner<3, 3>() = rotation_second;
  };
  const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d lever = Skew(p_waist);
  const Eigen::Matrix3d turned = J * R_foot_ref;
  set(result.by_waist, -R_foot_ref * lever, R_foot_ref, turned, zero);
  set(result.by_leg, -R_predicted_ref * lever, R_predicted_ref, turned, zero);
  set(result.by_foot, -one, Skew(seen), zero, -J);
  set(result.by_deflection, -one, zero, zero, -J * R_turned * LeftJacobian(-lean));
  return result;
}

}  // namespace elastocal
