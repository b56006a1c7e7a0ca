#include "elastocal/contact/touch_geometry.hpp"

#include <cmath>

namespace elastocal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d TableAxes(const Vector3d& height_tilts) {
  return (RotX(height_tilts[1]) * RotY(height_tilts[2])).linear();
}

}  // namespace

Vector3d TablePlane::Normal() const { return TableAxes(height_tilts).col(2); }

TouchResidual EvaluateTouch(const PlateFace& plate, const Eigen::Vector2d& tilts,
                            const TablePlane& table, const Transform& T_floor_root,
                            const Transform& T_root_link) {
  const Matrix3d& R = T_floor_root.linear();
  const Vector3d p_root = T_root_link * plate.p_link_face;
  const Vector3d p = T_floor_root * p_root;
  const Matrix3d untilted = R * T_root_link.linear() * plate.R_link_face;
  const Matrix3d face = untilted * (RotX(tilts[0]) * RotY(tilts[1])).linear();
  const Vector3d n = table.Normal();
  const Vector3d m = face.transpose() * n;

  TouchResidual touch;
  touch.residual << n.dot(p - table.pivot) - table.height_tilts[0], std::atan2(m.y(), m.z()),
      -std::asin(m.x());
  // Derivatives of the two angles by m.
  const double across = m.y() * m.y() + m.z() * m.z();
  Eigen::Matrix<double, 2, 3> by_m;
  by_m << 0.0, m.z() / across, -m.y() / across,  //
      -1.0 / std::sqrt(1.0 - m.x() * m.x()), 0.0, 0.0;
  // A rotation W of the face gives m by face' (n x W), one of the normal by face' (W x n).
  const Eigen::Matrix<double, 2, 3> by_turn = by_m * face.transpose() * Skew(n);

  Matrix3d turns;  // of the table: columns by tilt_x and tilt_y
  turns.col(0) = Vector3d::UnitX();
  turns.col(1) = RotX(table.height_tilts[1]).linear().col(1);
  touch.by_table.setZero();
  touch.by_table(0, 0) = -1.0;
  for (int i = 0; i < 2; ++i) {
    touch.by_table(0, 1 + i) = turns.col(i).cross(n).dot(p - table.pivot);
    touch.by_table.col(1 + i).tail<2>() = -by_turn * turns.col(i);
  }
  const Vector3d arm = p - T_floor_root.translation();
  touch.by_root.row(0) << arm.cross(n).transpose(), n.transpose();
  touch.by_root.bottomRows<2>() << by_turn, Eigen::Matrix<double, 2, 3>::Zero();
  const Vector3d n_root = R.transpose() * n;
  touch.by_link.row(0) << p_root.cross(n_root).transpose(), n_root.transpose();
  touch.by_link.bottomRows<2>() << by_turn * R, Eigen::Matrix<double, 2, 3>::Zero();
  touch.by_plate.row(0).setZero();
  touch.by_plate.col(0).tail<2>() = by_turn * untilted.col(0);
  touch.by_plate.col(1).tail<2>() = by_turn * untilted * RotX(tilts[0]).linear().col(1);
  return touch;
}

}  // namespace elastocal
