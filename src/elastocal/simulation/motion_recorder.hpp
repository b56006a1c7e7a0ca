// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// Records what a robot that plays a motion truly does, frame by frame.
class MotionRecorder {
 public:
  /// Keeps a reference to the robot.
  MotionRecorder(const TrueRobot& robot, const Motion& played, const Transform& T_camera_world);

  Eigen::Index frames() const { return motion.markers.rows(); }
  /// Records the poses of the soles at the beginning.
  void Begin(const VirtualRobot& body, std::size_t soles);
  void Record(Eigen::Index frame, const VirtualRobot& body);

  TrueMotion motion;

 private:
  const TrueRobot& robot_;
  Transform T_camera_world_;
};

/// The error that is thrown when a robot that stands freely falls.
InputError Fallen(double time_s);

}  // namespace elastocal
