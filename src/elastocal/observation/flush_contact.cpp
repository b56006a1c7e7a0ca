// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/flush_contact.hpp"

#include <cmath>

namespace elastocal {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<RowMeaning> FlushContact::rows() const {
  return {{"height", SourceUnit::kMetre},
          {"tilt_x", SourceUnit::kRadian},
          {"tilt_y", SourceUnit::kRadian}};
}

ObservationResidual FlushContact::Evaluate(const Sight& sight, const Eigen::VectorXd&) const {
  const Transform& T_floor_link = sight.T_floor_link[0];
  const Eigen::VectorXd& tilts = sight.values[0].x;
  const QuantityValue& table = sight.values[1];
  const Vector3d p = T_floor_link * face.p_link_face;
  const Matrix3d untilted = T_floor_link.linear() * face.R_link_face;
  const Matrix3d tilted = untilted * (RotX(tilts[0]) * RotY(tilts[1])).linear();
  const Vector3d n = table.Normal();
  const Vector3d m = tilted.transpose() * n;

  ObservationResidual touch;
  touch.left = Vector3d(table.HeightOver(p), std::atan2(m.y(), m.z()), -std::asin(m.x()));
  // Derivatives of the two angles by m.
  const double across = m.y() * m.y() + m.z() * m.z();
  Eigen::Matrix<double, 2, 3> by_m;
  by_m << 0.0, m.z() / across, -m.y() / across,  //
      -1.0 / std::sqrt(1.0 - m.x() * m.x()), 0.0, 0.0;
  // A rotation W of the face gives m by face' (n x W), one of the normal by face' (W x n).
  const Eigen::Matrix<double, 2, 3> by_turn = by_m * tilted.transpose() * Skew(n);

  ByScrew by_link(3, 6);
  by_link << n.transpose() * PointByScrew(p), by_turn * TurnByScrew();
  Eigen::MatrixXd by_plate = Eigen::MatrixXd::Zero(3, 2);
  by_plate.col(0).tail<2>() = by_turn * untilted.col(0);
  by_plate.col(1).tail<2>() = by_turn * untilted * RotX(tilts[0]).linear().col(1);
  Eigen::MatrixXd by_table = Eigen::MatrixXd::Zero(3, 3);
  by_table.row(0) = table.HeightByPlane(p);
  by_table.bottomRightCorner<2, 2>() = -by_turn * table.NormalTurns();
  touch.by_link = {by_link};
  touch.by_quantity = {by_plate, by_table};
  return touch;
}

void FlushContact::Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>&,
                         std::vector<QuantityValue*>& values) const {
  Vector3d mean = Vector3d::Zero();
  for (const Sight& sight : sights) mean += sight.T_floor_link[0] * face.p_link_face;
  values[1]->origin.translation() = mean / static_cast<double>(sights.size());
}

}  // namespace elastocal
