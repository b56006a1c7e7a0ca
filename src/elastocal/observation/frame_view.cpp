// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/frame_view.hpp"

namespace elastocal {

FrameView ViewFrom(const Transform& T_floor_parent, const QuantityValue& frame,
                   const Eigen::Vector3d& p_floor) {
  const Transform T_floor_frame = T_floor_parent * frame.Pose();
  const Eigen::Matrix3d R = T_floor_frame.linear().transpose();
  const Eigen::Vector3d arm = p_floor - T_floor_frame.translation();
  FrameView view;
  view.p = R * arm;
  view.by_point_screw = R * PointByScrew(p_floor);
  view.by_frame << -R * T_floor_parent.linear(),
      R * Skew(arm) * T_floor_parent.linear() * frame.Turns();
  return view;
}

}  // namespace elastocal
