#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// The worst value of a quantity over a motion, and where.
struct Worst {
  double value = 0.0;
  int sample = -1;
  int index = -1;  ///< of a joint, foot or pair of parts; -1: of none
};

/// How a motion keeps to what it should, over all samples.
struct MotionMargins {
  Worst position;      ///< least distance of a joint to the end of its range, rad or m
  Worst velocity;      ///< largest share of a joint's velocity limit
  Worst torque;        ///< largest share of a joint's effort limit, see CheckMotion
  Worst acceleration;  ///< largest of a joint, rad/s^2 or m/s^2
  Worst clearance;     ///< least distance between parts that may meet, m; infinite without parts
  Worst zmp;           ///< least distance of the zero-moment point to the edge of the support, m
  Worst friction;      ///< largest horizontal over vertical force of a foot
  Worst knee;          ///< least bend of a standing leg: of its most bent joint, rad
  Worst foot_moved;    ///< largest displacement of a standing foot, m
  Worst foot_turned;   ///< and rotation, rad
  Worst floor;         ///< least height of a corner of a foot that does not stand, m
};

/// What a motion breaks.
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
  kFloor
};

/// "torque limit" and the like, for messages.
const char* ConstraintName(Constraint constraint);

/// A motion as it will be played, whatever planned it.
struct SampledMotion {
  double rate_hz = 100.0;
  Eigen::MatrixXd q;                       ///< samples x coordinates
  std::vector<std::vector<int>> standing;  ///< by sample: feet on the floor, indices of soles
};

/// What goes with it.
struct MotionForces {
  std::vector<Transform> T_world_root;
  Eigen::MatrixX2d zmp;     ///< samples x 2, m
  Eigen::MatrixXd torques;  ///< samples x coordinates, N.m or N
};

/// Goes through a motion anew, from its joint positions alone: the root link's pose follows from
/// the first foot that stands (by the URDF's own kinematics; it stands where
/// robot.T_world_sole says), speeds and accelerations are differences, the floor's wrench is that
/// of inverse dynamics and two feet share it as ShareWrench says. At rest before and after.
/// `forces`, if given, is filled.
MotionMargins CheckMotion(const StandingRobot& robot, const SampledMotion& motion,
                          MotionForces* forces = nullptr);

/// What is broken, the first in the order of Constraint; a foot may move by 1e-6 m and rad.
std::optional<Constraint> Broken(const MotionMargins& margins, const MotionLimits& limits);

}  // namespace elastocal
