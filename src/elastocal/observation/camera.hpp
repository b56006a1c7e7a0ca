// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace elastocal {

/// A pinhole camera with radial and tangential distortion. Its parameters have the order and
/// meaning of OpenCV. The z axis of its frame points ahead, x to the right of the image, y down.
struct Camera {
  static constexpr int kNumbers = 9;
  double fx = 500.0, fy = 500.0, cx = 320.0, cy = 240.0;    ///< px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;  ///< distortion coefficients

  /// The camera with errors of its parameters, in the order fx, fy, cx, cy, k1, k2, p1, p2, k3.
  /// Errors of focal lengths are relative, those of the centre are in focal lengths, those of the
  /// distortion are absolute.
  Camera With(const Eigen::Ref<const Eigen::VectorXd>& errors) const;
};

/// The pixel at which a camera sees a point, px, with derivatives.
struct Pixel {
  Eigen::Vector2d at;
  Eigen::Matrix<double, 2, 3> by_point;                  ///< px/m
  Eigen::Matrix<double, 2, Camera::kNumbers> by_camera;  ///< by the errors of Camera::With
};

/// `p` is the point in the camera's frame, m, in front of it. `nominal` is the camera to whose
/// focal lengths the errors are relative; `camera` is the same with its errors.
Pixel PixelOf(const Camera& nominal, const Camera& camera, const Eigen::Vector3d& p);

}  // namespace elastocal
