// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// The worst value of a quantity over a motion, and where it occurs.
struct Worst {
  double value = 0.0;
  int sample = -1;
  int index = -1;  ///< index of the joint, foot or pair of parts; -1: none
};

/// Worst values of a motion over all samples.
struct MotionMargins {
  /// Least distance of a joint to the end of its range, rad or m. A joint with a small range (a
  /// finger) needs a margin of only 2 % of its range if that is less than
  /// MotionLimits::position_margin; the difference is added to its distance.
  Worst position;
  Worst velocity;      ///< largest share of a joint's velocity limit
  Worst torque;        ///< largest share of a joint's effort limit, see CheckMotion
  Worst acceleration;  ///< largest of a joint, rad/s^2 or m/s^2
  Worst clearance;     ///< least distance between parts that can touch, m; infinite without parts
  Worst zmp;  ///< least distance of the zero-moment point to the edge of the support polygon, m
  Worst friction;     ///< largest ratio of horizontal to vertical force at a foot
  Worst knee;         ///< least bend of the knee (the most bent joint) of a standing leg, rad
  Worst foot_moved;   ///< largest displacement of a standing foot, m
  Worst foot_turned;  ///< largest rotation of a standing foot, rad
  Worst floor;        ///< least height of a swinging foot (a corner, or the ball), m
  Worst lever;        ///< least LeverShare of a linkage; infinite without linkages
};

/// A limit that a motion can break.
enum class Constraint {
  kReach,
  kPosition,
  kVelocity,
  kTorque,
  kClearance,
  kZmp,
  kFriction,
  kKnee,
  kFeet,
  kFloor,
  kLever,
  kApproach
};

/// "torque limit" and the like, for messages.
const char* ConstraintName(Constraint constraint);

/// A motion as it will be played, whoever planned it.
struct SampledMotion {
  double rate_hz = 100.0;
  Eigen::MatrixXd q;                       ///< samples x coordinates
  std::vector<std::vector<int>> standing;  ///< feet on the floor, indices of soles, by sample
};

/// Zero-moment points and torques of a motion.
struct MotionForces {
  std::vector<Transform> T_world_root;
  Eigen::MatrixX2d zmp;     ///< samples x 2, m
  Eigen::MatrixXd torques;  ///< samples x coordinates, N.m or N
};

/// Computes the margins of a motion from its joint positions alone. The feet that stand give the
/// root link's pose (RootOverFeet, by the URDF's own kinematics).
/// Speeds and accelerations are differences, with rest before and after the motion. Inverse
/// dynamics give the floor's wrench, which the feet share by ShareWrench. Fills `forces`, if given.
MotionMargins CheckMotion(const StandingRobot& robot, const SampledMotion& motion,
                          MotionForces* forces = nullptr);

/// Tolerance for rounding: a standing foot may move by this, m or rad, and a swinging foot may be
/// so far below the floor, m.
inline constexpr double kFootTolerance = 1e-6;

/// All constraints that the margins break, in the order of Constraint.
std::vector<Constraint> BrokenConstraints(const MotionMargins& margins, const MotionLimits& limits);

/// The first of them, if any.
std::optional<Constraint> Broken(const MotionMargins& margins, const MotionLimits& limits);

}  // namespace elastocal
