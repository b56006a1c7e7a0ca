// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

/// A stretch of motion at a constant rate, from rest to rest, before it is balanced.
struct Stretch {
  double rate_hz = 100.0;
  /// samples x coordinates. Balancing computes the joints of the legs in `standing` and of `led`;
  /// the values given here for them only say which way the legs bend.
  Eigen::MatrixXd q;
  std::vector<int> standing;           ///< feet that stand still on the floor, indices of soles
  int led = -1;                        ///< foot that moves along given poses in the air; -1: none
  std::vector<Transform> T_world_led;  ///< poses of the sole of `led`, by sample; empty: no `led`
  Eigen::MatrixX2d zmp;                ///< where the zero-moment point should be, m
  PlacedPosture begin, end;            ///< balanced at rest, see BalanceAtRest

  int sample_count() const { return static_cast<int>(q.rows()); }
};

struct BalanceOptions {
  /// Weight alpha in eq. 13 of joint speeds [rad/s] against the error of the zero-moment point [m].
  double velocity_weight = 1e-3;
  /// Number of passes; each corrects the motion by its exact dynamics after the pass before.
  int passes = 5;
};

/// A balanced motion.
struct BalancedStretch {
  bool in_reach = false;  ///< whether all feet could be placed; nothing else is valid otherwise
  Eigen::MatrixXd q;      ///< samples x coordinates
  std::vector<Transform> T_world_root;  ///< one for each sample
  Eigen::MatrixX2d zmp;                 ///< of the balanced motion, m
};

/// Balances a stretch of motion (paper eq. 13): moves the root link horizontally so that the
/// zero-moment point of the whole motion, accelerations included, stays where it should be. The
/// speed of the standing legs' joints is the regularisation. Feet are fixed exactly, because
/// inverse kinematics give the joints of the standing legs from the root link's pose: that pose is
/// the unknown, instead of 6 or 12 joints. Height and attitude of the root link pass smoothly from
/// those of `begin` to those of `end`.
///
/// Eq. 13 is solved for all samples together, because accelerations couple them. A small
/// displacement d(t) of the root moves the zero-moment point as in the model of a cart on a table,
/// by s (d - h/g d''), where h is the height of the centre of mass and s the share of the
/// displacement that the centre of mass follows. Each pass is therefore a linear least-squares
/// problem with a band matrix. Its result is smooth and begins to move before it has to. The first
/// and last three samples are at rest.
///
/// Limits are not checked here; see motion_check.hpp.
BalancedStretch Balance(const StandingRobot& robot, const Stretch& stretch,
                        const BalanceOptions& options);

/// Pose of the root link after a share of its way from one pose to another, without regard to
/// dynamics: straight, and turning about one axis.
Transform RootBetween(const Transform& begin, const Transform& end, double share);

}  // namespace elastocal
