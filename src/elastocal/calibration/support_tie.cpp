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
  result.by_waist << -R_foot_ref * Skew(p_waist), R_foot_ref, J * R_foot_ref,
      Eigen::Matrix3d::Zero();
  result.by_leg << -R_predicted_ref * Skew(p_waist), R_predicted_ref, J * R_foot_ref,
      Eigen::Matrix3d::Zero();
  result.by_foot << -Eigen::Matrix3d::Identity(), Skew(seen), Eigen::Matrix3d::Zero(), -J;
  result.by_deflection << -Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero(),
      Eigen::Matrix3d::Zero(), -J * R_turned * LeftJacobian(-lean);
  return result;
}

}  // namespace elastocal
