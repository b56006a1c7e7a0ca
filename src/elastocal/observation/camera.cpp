// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/camera.hpp"

namespace elastocal {

Camera Camera::With(const Eigen::Ref<const Eigen::VectorXd>& errors) const {
  Camera camera = *this;
  camera.fx += fx * errors[0];
  camera.fy += fy * errors[1];
  camera.cx += fx * errors[2];
  camera.cy += fy * errors[3];
  camera.k1 += errors[4];
  camera.k2 += errors[5];
  camera.p1 += errors[6];
  camera.p2 += errors[7];
  camera.k3 += errors[8];
  return camera;
}

Pixel PixelOf(const Camera& nominal, const Camera& camera, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z();
  const double y = p.y() / p.z();
  const double square = x * x + y * y;
  const double radial = 1.0 + square * (camera.k1 + square * (camera.k2 + square * camera.k3));
  const double radial_by_square = camera.k1 + square * (2.0 * camera.k2 + square * 3.0 * camera.k3);
  const Eigen::Vector2d bent(
      x * radial + 2.0 * camera.p1 * x * y + camera.p2 * (square + 2.0 * x * x),
      y * radial + camera.p1 * (square + 2.0 * y * y) + 2.0 * camera.p2 * x * y);
  const Eigen::DiagonalMatrix<double, 2> focal(camera.fx, camera.fy);

  Pixel pixel;
  pixel.at = Eigen::Vector2d(camera.cx, camera.cy) + focal * bent;
  Eigen::Matrix2d bent_by_xy;
  const double cross = 2.0 * (x * y * radial_by_square + camera.p1 * x + camera.p2 * y);
  bent_by_xy << radial + 2.0 * x * x * radial_by_square + 2.0 * camera.p1 * y + 6.0 * camera.p2 * x,
      cross, cross,
      radial + 2.0 * y * y * radial_by_square + 6.0 * camera.p1 * y + 2.0 * camera.p2 * x;
  Eigen::Matrix<double, 2, 3> xy_by_point;
  xy_by_point << 1.0, 0.0, -x, 0.0, 1.0, -y;
  pixel.by_point = focal * bent_by_xy * xy_by_point / p.z();
  const Eigen::Vector2d xy(x, y);
  pixel.by_camera.setZero();
  pixel.by_camera(0, 0) = nominal.fx * bent.x();
  pixel.by_camera(1, 1) = nominal.fy * bent.y();
  pixel.by_camera(0, 2) = nominal.fx;
  pixel.by_camera(1, 3) = nominal.fy;
  pixel.by_camera.col(4) = focal * xy * square;
  pixel.by_camera.col(5) = focal * xy * square * square;
  pixel.by_camera.col(6) = focal * Eigen::Vector2d(2.0 * x * y, square + 2.0 * y * y);
  pixel.by_camera.col(7) = focal * Eigen::Vector2d(square + 2.0 * x * x, 2.0 * x * y);
  pixel.by_camera.col(8) = focal * xy * square * square * square;
  return pixel;
}

}  // namespace elastocal
