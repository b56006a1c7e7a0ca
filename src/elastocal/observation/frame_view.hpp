// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A point in a frame whose pose is a quantity (a tracker, a camera) on the floor or on a link,
/// with derivatives.
struct FrameView {
  Eigen::Vector3d p;                           ///< position in the frame, m
  Eigen::Matrix<double, 3, 6> by_point_screw;  ///< by the screw of the link that carries the point
  Eigen::Matrix<double, 3, 6> by_frame;        ///< by the six numbers of the frame's pose
};

/// `T_floor_parent` is the pose of what carries the frame. The derivative of p by its screw is
/// by_point_screw with the opposite sign.
FrameView ViewFrom(const Transform& T_floor_parent, const QuantityValue& frame,
                   const Eigen::Vector3d& p_floor);

}  // namespace elastocal
