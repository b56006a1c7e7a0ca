// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/true_motion.hpp"

#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/standing_feet.hpp"

namespace elastocal {
namespace {

void CheckStanding(const Transform& T_world_waist, double height, double time_s) {
  constexpr double kLeastHeight = 0.7;
  if (T_world_waist.translation().z() > kLeastHeight * height) return;
  throw InputError("the robot fell after " + std::to_string(time_s) +
                   " s: a robot that stands freely needs motions that keep its balance");
}

}  // namespace

TrueMotion PlayMotion(const TrueRobot& robot, const std::vector<int>& support, const Motion& motion,
                      const Transform& T_camera_world, const PhysicsOptions& options) {
  constexpr double kLongestCreep = 4.0;  // s; friction may go on creeping
  TrueMotion result;
  for (const Marker& marker : robot.markers) result.marker_names.push_back(marker.name);
  for (int k : robot.tree.coordinate_joint) {
    result.joint_names.push_back(robot.tree.joints[static_cast<std::size_t>(k)].name);
  }
  const auto frames = static_cast<Eigen::Index>(std::lround(motion.duration_s() * result.rate_hz));
  const auto joints = static_cast<Eigen::Index>(result.joint_names.size());
  result.markers.resize(frames, 3 * static_cast<Eigen::Index>(robot.markers.size()));
  result.encoders.resize(frames, joints);
  result.torques.resize(frames, joints);

  VirtualRobot body(robot, support, PostureAt(motion, 0.0), options);
  body.Settle(kLongestCreep);
  const double height = body.WaistPose().translation().z();
  for (std::size_t s = 0; s < support.size(); ++s) {
    result.T_camera_foot.push_back(T_camera_world * body.SolePose(static_cast<int>(s)));
  }
  int steps = 0;
  for (Eigen::Index i = 0; i < frames; ++i) {
    const double time_s = static_cast<double>(i) / result.rate_hz;
    for (; steps * body.time_step_s() < time_s - 1e-9; ++steps) {
      body.Command(PostureAt(motion, (steps + 1) * body.time_step_s()));
      body.Step();
    }
    Eigen::Matrix3Xd markers = body.MarkerPositions();
    if (robot.creeping_marker >= 0) {
      const int link = robot.markers[static_cast<std::size_t>(robot.creeping_marker)].link;
      markers.col(robot.creeping_marker) +=
          robot.creep * time_s / 3600.0 * body.LinkPose(link).linear().col(0);
    }
    result.markers.row(i) = (T_camera_world * markers).reshaped().transpose();
    const Eigen::VectorXd encoders = body.Encoders();
    const Eigen::VectorXd torques = body.Torques();
    for (Eigen::Index c = 0; c < joints; ++c) {
      const int k = robot.tree.coordinate_joint[static_cast<std::size_t>(c)];
      result.encoders(i, c) = encoders[k];
      result.torques(i, c) = torques[k];
    }
    result.T_camera_waist.push_back(T_camera_world * body.WaistPose());
    if (StandsFreely(support, options)) CheckStanding(body.WaistPose(), height, time_s);
  }
  return result;
}

}  // namespace elastocal
