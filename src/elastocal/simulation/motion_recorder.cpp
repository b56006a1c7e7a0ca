// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/motion_recorder.hpp"

#include <cmath>

#include "elastocal/math/numbers.hpp"

namespace elastocal {

MotionRecorder::MotionRecorder(const TrueRobot& robot, const Motion& played,
                               const Transform& T_camera_world)
    : robot_(robot), T_camera_world_(T_camera_world) {
  for (const Marker& marker : robot.markers) motion.marker_names.push_back(marker.name);
  for (int k : robot.tree.coordinate_joint) {
    motion.joint_names.push_back(robot.tree.joints[Size(k)].name);
  }
  const auto frames = static_cast<Eigen::Index>(std::lround(played.duration_s() * motion.rate_hz));
  const auto joints = static_cast<Eigen::Index>(motion.joint_names.size());
  motion.markers.resize(frames, 3 * static_cast<Eigen::Index>(robot.markers.size()));
  motion.encoders.resize(frames, joints);
  motion.torques.resize(frames, joints);
}

void MotionRecorder::Begin(const VirtualRobot& body, std::size_t soles) {
  for (std::size_t s = 0; s < soles; ++s) {
    motion.T_camera_foot.push_back(T_camera_world_ * body.SolePose(static_cast<int>(s)));
  }
}

void MotionRecorder::Record(Eigen::Index frame, const VirtualRobot& body) {
  Eigen::Matrix3Xd markers = body.MarkerPositions();
  if (robot_.creeping_marker >= 0) {
    const double time_s = static_cast<double>(frame) / motion.rate_hz;
    const int link = robot_.markers[Size(robot_.creeping_marker)].link;
    markers.col(robot_.creeping_marker) +=
        robot_.creep * time_s / 3600.0 * body.LinkPose(link).linear().col(0);
  }
  motion.markers.row(frame) = (T_camera_world_ * markers).reshaped().transpose();
  const Eigen::VectorXd encoders = body.Encoders();
  const Eigen::VectorXd torques = body.Torques();
  for (Eigen::Index c = 0; c < motion.encoders.cols(); ++c) {
    const int k = robot_.tree.coordinate_joint[Size(c)];
    motion.encoders(frame, c) = encoders[k];
    motion.torques(frame, c) = torques[k];
  }
  motion.T_camera_waist.push_back(T_camera_world_ * body.WaistPose());
}

InputError Fallen(double time_s) {
  return InputError(
      "the robot fell after " + std::to_string(time_s) +
      " s: a robot that stands freely needs motions that keep its balance (elastocal plan "
      "makes them of postures; play them with --motion)");
}

}  // namespace elastocal
