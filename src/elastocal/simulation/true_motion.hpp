// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/simulation/motions.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// What truly happened in a trial, sampled at a constant rate on the cameras' clock. It is the
/// interface between the robot that plays a motion and the sensors that measure it.
struct TrueMotion {
  double rate_hz = 100.0;
  std::vector<std::string> marker_names, joint_names;  ///< without mimic joints
  Eigen::MatrixXd markers;   ///< frames x 3 N_M, m, in the cameras' frame (z up)
  Eigen::MatrixXd encoders;  ///< frames x joints: exact positions on the encoders' side, rad or m
  Eigen::MatrixXd
      torques;  ///< frames x joints: torques of the drives, which balance the load, N.m or N
  std::vector<Transform> T_camera_waist;  ///< of the root link, one for each frame
  std::vector<Transform>
      T_camera_foot;  ///< of the soles on the floor at the beginning of the trial

  int frame_count() const { return static_cast<int>(markers.rows()); }
};

/// Plays a motion on the true robot in MuJoCo, after it has come to rest in the first posture.
/// Throws InputError if a robot that stands freely falls.
TrueMotion PlayMotion(const TrueRobot& robot, const std::vector<int>& support, const Motion& motion,
                      const Transform& T_camera_world, const PhysicsOptions& options);

}  // namespace elastocal
