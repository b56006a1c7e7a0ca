#pragma once

#include <vector>

#include "elastocal/motion/stabiliser.hpp"
#include "elastocal/robot/joint_motion.hpp"
#include "elastocal/robot/standing.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// How a robot that stands free came through a motion.
struct StandingRun {
  bool stood = false;         ///< to the end: the waist never sank below 0.7 of its height
  double time_s = 0.0;        ///< until it fell, or the whole
  double largest_lean = 0.0;  ///< of the root link's z axis from where it points at the begin, rad
  double tracking = 0.0;      ///< largest difference of encoders and command, rad or m
  /// Least distance of the zero-moment point of the true contact forces to the edge of the soles
  /// that are pressed (50 N and more), m; around 0 where the robot stands on an edge.
  double least_zmp_margin = 0.0;
  double largest_shift = 0.0;  ///< of the root link by the stabiliser, m
};

/// Plays a whole motion, changes of support included, on a robot whose soles lie free on the floor.
/// It begins with all `soles` on the floor and at rest. `motion` needs times and supports; samples
/// are joined by straight lines. Where there is a `stabiliser` (of the same soles), it corrects the
/// commands 100 times a second by what the robot's inertial unit and feet feel; otherwise the
/// joints follow the motion and nothing watches the balance.
StandingRun StandThrough(const TrueRobot& robot, const std::vector<Sole>& soles,
                         const JointMotion& motion, PhysicsOptions options,
                         Stabiliser* stabiliser = nullptr);

}  // namespace elastocal
