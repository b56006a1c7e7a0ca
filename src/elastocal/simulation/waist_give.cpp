// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/waist_give.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {

std::vector<Eigen::Index> RestFrames(const Motion& motion, const TrueMotion& played) {
  std::vector<Eigen::Index> frames;
  double time_s = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    time_s += segment.duration_s;
    const auto frame = static_cast<Eigen::Index>(std::lround(time_s * played.rate_hz)) - 1;
    if (segment.IsRest() && frame >= 0 && frame < played.frame_count()) frames.push_back(frame);
  }
  return frames;
}

WaistGive LargestWaistGive(
    const TrueMotion& played, const std::vector<Eigen::Index>& frames,
    const std::function<Transform(const Eigen::VectorXd& encoders)>& T_foot_waist) {
  WaistGive largest;
  for (Eigen::Index frame : frames) {
    const Transform rigid =
        played.T_camera_foot[0] * T_foot_waist(played.encoders.row(frame).transpose());
    const Transform& found = played.T_camera_waist[static_cast<std::size_t>(frame)];
    largest.translation =
        std::max(largest.translation, (found.translation() - rigid.translation()).norm());
    largest.rotation =
        std::max(largest.rotation, RotationAngle(rigid.linear().transpose() * found.linear()));
  }
  return largest;
}

}  // namespace elastocal
