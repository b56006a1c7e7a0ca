// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/instrument.hpp"

namespace elastocal {

void Instrument::Begin(const std::vector<Sight>&, const std::vector<Eigen::VectorXd>&,
                       std::vector<QuantityValue*>&) const {}

void Instrument::AddLandmarks(const Sight&, const Eigen::VectorXd&, Landmarks&) const {}

Eigen::MatrixXd Instrument::Weights(const Spread& spread) const {
  Eigen::VectorXd inverse(size());
  for (int row = 0; row < size(); ++row) inverse[row] = 1.0 / spread[noise[row]];
  if (whitening.size() == 0) return inverse.asDiagonal();
  return inverse.asDiagonal() * whitening;
}

Eigen::Matrix<double, 3, 6> PointByScrew(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> by_screw;
  by_screw << -Skew(p), Eigen::Matrix3d::Identity();
  return by_screw;
}

Eigen::Matrix<double, 3, 6> TurnByScrew() {
  Eigen::Matrix<double, 3, 6> by_screw;
  by_screw << Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
  return by_screw;
}

}  // namespace elastocal
