// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace elastocal {

/// A pinhole camera with radial and tangential distortion, in the order and the meaning that OpenCV
/// gives them. z of its frame looks ahead, x to the right of the image, y down.
struct Camera {
  static constexpr int kNumbers = 9;
  double fx = 500.0, fy = 500.0, cx = 320.0, cy = 240.0;    ///< px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;  ///< distortion

  /// The camera with errors of its numbers: relative ones of the focal lengths, those of the centre
  /// in focal lengths, those of the distortion as they are; in the order fx, fy, cx, cy, k1, k2,
  /// p1, p2, k3.
  Camera With(const Eigen::Ref<const Eigen::VectorXd>& errors) const;
};

/// Where a camera sees a point, px.
struct Pixel {
  Eigen::Vector2d at;
  Eigen::Matrix<double, 2, 3> by_point;                  ///< px/m
  Eigen::Matrix<double, 2, Camera::kNumbers> by_camera;  ///< by the errors of Camera::With
};

/// `p`: in the camera's frame, m, in front of it. `nominal`: the camera whose focal lengths the
/// errors are relative to; `camera`: the same with its errors.
Pixel PixelOf(const Camera& nominal, const Camera& camera, const Eigen::Vector3d& p);

}  // namespace elastocal
