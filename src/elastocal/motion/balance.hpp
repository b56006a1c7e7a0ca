#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// A stretch of motion at a constant rate, from rest to rest, before it is balanced.
struct Stretch {
  double rate_hz = 100.0;
  /// samples x coordinates. Joints of legs in `standing` and of `led` are found by balancing; what
  /// is given for them only tells which way they bend.
  Eigen::MatrixXd q;
  std::vector<int> standing;  ///< feet that carry and stay where they stand, indices of soles
  int led = -1;               ///< a foot in the air that is led through the world; -1: none
  std::vector<Transform> T_world_led;  ///< by sample, where `led` is given
  Eigen::MatrixX2d zmp;                ///< where the zero-moment point should be, m
  PlacedPosture begin, end;            ///< balanced at rest, see BalanceAtRest

  int sample_count() const { return static_cast<int>(q.rows()); }
};

struct BalanceOptions {
  /// Weight alpha of eq. 13 of joint speeds [rad/s] against the zero-moment point's error [m].
  double velocity_weight = 1e-3;
  /// Passes of correction, each with the exact dynamics of the motion before.
  int passes = 5;
};

/// A balanced motion.
struct BalancedStretch {
  bool in_reach = false;  ///< whether all feet could be placed; nothing else is valid otherwise
  Eigen::MatrixXd q;      ///< samples x coordinates
  std::vector<Transform> T_world_root;  ///< by sample
  Eigen::MatrixX2d zmp;                 ///< of the motion as it is, m
};

/// Balances a stretch of motion (paper eq. 13): moves the root link horizontally so that the
/// zero-moment point of the whole motion, accelerations included, stays where it should be, with
/// regularisation by the speed of the stabilising joints. Feet are fixed exactly, since the joints
/// of the standing legs follow from the root link's pose by inverse kinematics: that pose is the
/// unknown in place of 6 or 12 joints. Height and attitude of the root link are those of `begin`,
/// passing smoothly to those of `end`.
///
/// Eq. 13 is solved for all samples together, since accelerations tie them: about the motion found
/// so far the zero-moment point answers to a displacement d(t) of the root like a cart on a table,
/// s (d - h/g d''), h the height of the centre of mass and s the share of it that follows the root;
/// so each pass is a linear least-squares problem with a band matrix, and the motion is smooth
/// and knows ahead what will come. The first and last three samples are at rest.
///
/// Limits are not looked at here; see motion_check.hpp.
BalancedStretch Balance(const StandingRobot& robot, const Stretch& stretch,
                        const BalanceOptions& options);

}  // namespace elastocal
