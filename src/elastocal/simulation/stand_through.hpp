#pragma once

#include <vector>

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
  /// Least distance of the zero-moment point of the true contact forces to the edge of what the
  /// soles that should stand cover, m; negative: the robot stood on an edge.
  double least_zmp_margin = 0.0;
};

/// Plays a whole motion, changes of support included, on a robot whose soles lie free on the floor,
/// joints following their commands alone: nothing watches the balance. It begins with all `soles`
/// on the floor and at rest. `motion` needs times and supports; samples are joined by straight
/// lines.
StandingRun StandThrough(const TrueRobot& robot, const std::vector<Sole>& soles,
                         const JointMotion& motion, PhysicsOptions options);

}  // namespace elastocal
