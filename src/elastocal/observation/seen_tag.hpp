// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/camera.hpp"
#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A square tag that a camera sees. It measures u, v of the four corners, px. Camera and tag are
/// each on the floor or on a link; `links` holds these links, the camera's first.
///
/// Quantities: the pose of the camera and that of the tag, in their links (or on the floor); the
/// errors of the camera's parameters (Camera::With).
class SeenTag : public Instrument {
 public:
  Camera camera = {};
  /// Corners in the tag's frame, m, in the order of AprilTag: counterclockwise from the lower left
  /// in the image of an upright tag; z points out of the tag.
  Eigen::Matrix<double, 3, 4> p_tag_corner = Eigen::Matrix<double, 3, 4>::Zero();
  /// Carried by a link; if false, fixed on the floor.
  bool camera_carried = true, tag_carried = true;

  const char* kind() const override { return "image"; }
  std::vector<RowMeaning> rows() const override {
    return std::vector<RowMeaning>(8, {"pixel", SourceUnit::kPixel});
  }
  int measured_size() const override { return 8; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  /// Whether all corners lie ahead of the camera and in the image, and the tag faces the camera.
  /// The camera's centre is taken as the middle of the image.
  bool Sees(const Sight& sight) const override;

 private:
  Transform CameraParent(const Sight& sight) const;
  Transform TagParent(const Sight& sight) const;
};

/// The corners that would be measured for a tag `factor` times as large in the same place, from the
/// measured ones. These determine the projective map by which the tag's plane is seen. (Distortion
/// within the tag is neglected.)
Eigen::VectorXd CornersOfLargerTag(const Eigen::VectorXd& corners, double factor);

}  // namespace elastocal
