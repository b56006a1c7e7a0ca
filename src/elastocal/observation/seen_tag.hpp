// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/camera.hpp"
#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A square tag that a camera sees: measured are u, v of its four corners, px. Camera and tag are
/// each on the floor or on a link; `links` holds those links, the camera's first.
///
/// Quantities: the pose of the camera, that of the tag, in their links (on the floor); the errors
/// of the camera's numbers (Camera::With).
class SeenTag : public Instrument {
 public:
  Camera camera = {};
  /// Corners in the tag's frame, m: in the order of the image of an upright tag from below left,
  /// counterclockwise, as AprilTag has them; z out of the tag.
  Eigen::Matrix<double, 3, 4> p_tag_corner = Eigen::Matrix<double, 3, 4>::Zero();
  bool camera_carried = true, tag_carried = true;  ///< by a link

  const char* kind() const override { return "image"; }
  std::vector<RowMeaning> rows() const override {
    return std::vector<RowMeaning>(8, {"pixel", SourceUnit::kPixel});
  }
  int measured_size() const override { return 8; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  /// All corners lie ahead and in the image, which is taken to have the camera's centre in its
  /// middle, and the tag faces the camera.
  bool Sees(const Sight& sight) const override;

 private:
  Transform CameraParent(const Sight& sight) const;
  Transform TagParent(const Sight& sight) const;
};

/// The corners that would be measured of a tag `factor` times as large in the same place, from
/// those that were: its plane is seen by a projective map, which they determine. (Distortion within
/// the tag is neglected.)
Eigen::VectorXd CornersOfLargerTag(const Eigen::VectorXd& corners, double factor);

}  // namespace elastocal
