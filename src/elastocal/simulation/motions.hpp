// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/simulation/postures.hpp"

namespace elastocal {

/// A piece of a motion: a move from one posture to another, at rest at both ends; a sine of one
/// joint around a posture; or given samples.
struct MotionSegment {
  double duration_s = 0.0;
  Eigen::VectorXd from,
      to;               ///< by coordinate; for a sine, both are the posture around which it moves
  int coordinate = -1;  ///< coordinate of a sine; -1: a quintic polynomial between postures
  double centre = 0.0, amplitude = 0.0, frequency_hz = 0.0;  ///< of a sine: rad or m, Hz
  /// Given samples: their times from the segment's beginning, and their positions, samples x
  /// coordinates, joined by Catmull-Rom's cubics. Empty for other segments.
  Eigen::VectorXd sample_s = {};
  Eigen::MatrixXd samples = {};

  bool IsRest() const { return coordinate < 0 && sample_s.size() == 0 && from == to; }
};

/// A joint trajectory that the robot is commanded.
struct Motion {
  std::vector<MotionSegment> segments;

  double duration_s() const;
};

/// The commanded posture at a time from the motion's beginning. Before and after the motion, it is
/// the first and last posture.
Eigen::VectorXd PostureAt(const Motion& motion, double time_s);

struct MotionOptions {
  std::uint64_t seed = 1;
  PostureOptions postures;
  double lead_in_s =
      5.0;  ///< time at rest before the first motion (cameras start before the robot's log)
  double move_s = 3.5, rest_s = 1.5;  ///< for each posture; together 5 s, as in the paper
  int head_postures = 8;  ///< for chains with fewer than PostureOptions::arm_joints joints
  int arm_postures = 32;  ///< for other chains that are not legs
  int leg_postures = 24;  ///< for each leg, while another supports the robot
  /// While a leg swings, head, arms and trunk move too, by this share of the way to their own
  /// random postures. This loads the support leg differently each time.
  double counterweight = 1.0;
  int random_postures = 20;  ///< in each validation trial
  int repetitions = 5;
  double sine_hz = 0.5;
  double sine_periods = 2.0;  ///< for each joint; one more to begin and one to end
  double sine_share =
      0.8;  ///< share of a joint's range that a sine spans, if speed and space allow
  double speed_share = 0.8;  ///< share of a joint's largest speed that a sine may reach
};

/// A trial to be played.
struct PlannedTrial {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  std::vector<int> chains;   ///< indices into the given chains
  std::vector<int> support;  ///< feet that stand on the floor: links
  Motion motion;
  int postures = 0;  ///< number of postures in which the robot rests
  /// The first foot of `support` stands where it stood in the trial before: the robot was not put
  /// down anew.
  bool stays = false;
};

/// Plans the trials of the paper's sections 5 and 6 for any robot. Each chain from the waist has a
/// trial of calibration postures (a leg moves while another supports the robot; a single leg has
/// none). For validation, there are trials of head, arms and trunk together and of each leg: a
/// sinusoidal motion of one joint after the other, random postures, and five repetitions of one
/// motion. Chains that begin beyond the waist are exercised with those that carry them and have no
/// trial of their own. Head, arms and trunk move while the robot stands on all feet. The root link
/// of a robot that cannot stand on one or two flat feet is held still, and its legs are exercised
/// like arms.
std::vector<PlannedTrial> PlanTrials(const RobotTree& tree, const std::vector<NamedChain>& chains,
                                     const MotionOptions& options);

}  // namespace elastocal
