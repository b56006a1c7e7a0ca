// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "elastocal/motion/stabiliser.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/robot/standing.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// How a robot that stands freely went through a motion.
struct StandingRun {
  bool stood = false;   ///< whether it never fell (VirtualRobot::FallenFrom its height at first)
  double time_s = 0.0;  ///< until the fall, or duration of the whole motion
  double largest_lean =
      0.0;  ///< largest angle of the root link's z axis to its direction at the beginning, rad
  double tracking = 0.0;  ///< largest difference of encoders and command, rad or m
  /// Least distance of the zero-moment point of the true contact forces to the edge of the loaded
  /// soles, m. A sole is loaded if it carries more than a twentieth of the vertical force. Forces
  /// are averaged over the time in which the robot would fall, sqrt(height / gravity), and only
  /// while the planned support is the same, because a firm sole that meets the floor is on its edge
  /// for a hundredth of a second. The margin is around 0 when the robot stands on an edge.
  double least_zmp_margin = 0.0;
  double largest_shift = 0.0;  ///< largest shift of the root link by the stabiliser, m
};

/// How a controller plays a motion.
struct StandThroughOptions {
  Stabiliser* stabiliser = nullptr;  ///< none: nothing controls the balance
  /// Orientation of the root link in the rest at the beginning, by the controller's model. If
  /// given, this rest tells how the inertial unit is mounted: markers do not determine the root
  /// frame of a calibration (the gauge), which may be inclined to the true one. The error of the
  /// zero-moment point in this rest is then taken for an error of masses (Stabiliser::TakeRest).
  /// Without it, the unit sits in the root frame of the robot description, and masses are as
  /// described.
  std::optional<Eigen::Matrix3d> R_world_root_at_rest = {};
  /// Commanded positions, samples x coordinates, if they differ from the motion (for instance
  /// corrected by a calibration). Times and support are those of the motion.
  const Eigen::MatrixXd* commanded = nullptr;
  /// Called 100 times a second with the last sample of the motion, the planned posture at that time
  /// (interpolated between samples) and the robot.
  std::function<void(Eigen::Index sample, const Eigen::VectorXd& planned,
                     const VirtualRobot& robot)>
      watch = {};
};

/// Plays a whole motion, changes of support included, on a robot whose soles lie freely on the
/// floor. It begins at rest with all `soles` on the floor. `motion` needs times and support;
/// samples are joined by straight lines. A `stabiliser` (of the same soles) corrects the commands
/// 100 times a second by the measurements of the inertial unit and the feet. Without it, the joints
/// follow the motion and nothing controls the balance.
///
/// Before the motion the robot is put down in its first posture, 4 s at the most. With a stabiliser
/// whose unit sits in the root frame, hands hold the root link upright meanwhile and let go slowly.
StandingRun StandThrough(const TrueRobot& robot, const std::vector<Sole>& soles,
                         const JointMotion& motion, PhysicsOptions physics,
                         const StandThroughOptions& options = {});

}  // namespace elastocal
