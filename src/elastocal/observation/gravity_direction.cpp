// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/gravity_direction.hpp"

#include <Eigen/SVD>

#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kHardlyKnown = 1e-4;  // weight of the given mounting, relative to one measurement

/// Reading of an ideal accelerometer at rest, in the axes of the link.
Eigen::Vector3d UpInLink(const Sight& sight) {
  return sight.T_floor_link[0].linear().transpose() * -kGravity;
}

}  // namespace

ObservationResidual GravityDirection::Evaluate(const Sight& sight,
                                               const Eigen::VectorXd& measured) const {
  const QuantityValue& unit = sight.values[0];
  const Eigen::Matrix3d R_unit_link = unit.Rotation(0).transpose();
  const Eigen::Vector3d up = UpInLink(sight);
  const double scale = 1.0 + unit.x[6];
  Eigen::MatrixXd by_unit(3, 7);
  by_unit << scale * R_unit_link * Skew(up) * unit.Turns(0), Eigen::Matrix3d::Identity(),
      R_unit_link * up;
  const Eigen::Matrix3d R_unit_floor = R_unit_link * sight.T_floor_link[0].linear().transpose();
  return {Predict(sight) - measured,
          {scale * R_unit_floor * Skew(-kGravity) * TurnByScrew()},
          {by_unit}};
}

Eigen::VectorXd GravityDirection::Predict(const Sight& sight) const {
  const QuantityValue& unit = sight.values[0];
  return (1.0 + unit.x[6]) * (unit.Rotation(0).transpose() * UpInLink(sight)) +
         unit.x.segment<3>(3);
}

void GravityDirection::Begin(const std::vector<Sight>& sights,
                             const std::vector<Eigen::VectorXd>& measured,
                             std::vector<QuantityValue*>& values) const {
  // Wahba's problem, solved by singular values.
  Eigen::Matrix3d sum = kHardlyKnown * values[0]->origin.linear();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    sum += UpInLink(sights[i]).normalized() * measured[i].normalized().transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d signs(
      1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  values[0]->origin.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace elastocal
